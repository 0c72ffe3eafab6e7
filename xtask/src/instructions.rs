//! `cargo xtask instructions`: what a conversion takes of the processor at 4000/s.
//!
//! `inm-count` (firmware/src/counting.rs) counts instructions under QEMU; this makes cycles and
//! time of them and holds them to what the converters allow. Instructions are not cycles: the
//! assumption stands at [`CYCLES_PER_INSTRUCTION`], and the last line says how far it may be off.

use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::image::Image;
use crate::run::output;
use crate::tools::{ensure_qemu, ensure_target, qemu};

/// Core clock, hertz.
const CORE_HZ: f64 = 168e6;

/// Conversions a second, the most that the link carries.
const RATE_HZ: f64 = 4000.0;

/// An assumption, not a measurement. On the Cortex-M4 most instructions take one cycle, loads and
/// stores two unless they follow each other, taken branches two to four (Arm, Cortex-M4 TRM,
/// table 3-1). The flash needs five wait states at this clock; ST states that its accelerator
/// makes them equivalent to none (DS8626), which holds for loops and less for code that is
/// passed once.
const CYCLES_PER_INSTRUCTION: f64 = 1.5;

/// Cycles into an interrupt and out of it (Arm, Cortex-M4 TRM, section 3.9).
const INTERRUPT_CYCLES: f64 = 24.0;

/// Axes, and SCLK in hertz (firmware/src/image).
const AXES: f64 = 3.0;
const SPI_HZ: f64 = 1_312_500.0;

/// The driver waits that long behind each word, and the acquisition gives up a word that would
/// not end that long before the next conversion; seconds.
const BEHIND_WORD_S: f64 = 0.98e-6;
const BEFORE_NEXT_S: f64 = 5e-6;

/// What was counted of one part.
struct Part {
    name: String,
    mean: f64,
    most: f64,
    worst: f64,
}

/// Everything that the image said.
#[derive(Default)]
struct Counted {
    /// By part, in the order of the work.
    parts: Vec<Part>,
    /// Name, instructions on average and at most.
    alone: Vec<(String, f64, f64)>,
    /// Bytes on the link for each conversion.
    link_bytes: f64,
    /// Of an interrupt that sends nothing, and of each byte that it sends.
    interrupt: f64,
    byte: f64,
    /// Of the interrupt of an edge.
    edge: f64,
}

/// Builds the image, runs it and shows the table.
///
/// # Errors
/// A build or QEMU fails, the image says something else than it should, or a conversion could be
/// lost.
pub fn run() -> Result<()> {
    ensure_target()?;
    ensure_qemu()?;
    check()
}

/// As [`run`], with everything installed.
///
/// # Errors
/// As [`run`].
pub fn check() -> Result<()> {
    let image = Image::Count.build()?;
    let mut qemu = Command::new(qemu());
    qemu.args(["-M", "netduinoplus2", "-nographic", "-monitor", "none"])
        .args(["-serial", "null", "-icount", "shift=0,sleep=off"])
        .args(["-chardev", "stdio,id=said"])
        .args([
            "-semihosting-config",
            "enable=on,target=native,chardev=said",
        ])
        .arg("-kernel")
        .arg(image)
        .stdin(Stdio::null());
    let counted = Counted::parse(&output(&mut qemu)?)?;
    counted.show();
    counted.hold_to_the_period()
}

impl Counted {
    fn parse(said: &str) -> Result<Self> {
        let mut counted = Self::default();
        let mut conversions = 1.0;
        for line in said.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let number = |place: usize| -> Result<f64> {
                let word = words.get(place).and_then(|word| word.parse().ok());
                word.with_context(|| format!("the image said `{line}`"))
            };
            match words[..] {
                ["conversions", _] => conversions = number(1)?,
                ["part", "outside", ..] => {}
                ["part", name, ..] => counted.parts.push(Part {
                    name: name.to_owned(),
                    mean: number(2)? / conversions,
                    most: number(3)?,
                    worst: number(4)?,
                }),
                ["alone", name, ..] => {
                    let mean = number(3)? / number(2)?;
                    counted.alone.push((name.to_owned(), mean, number(4)?));
                }
                ["link", ..] => counted.link_bytes = number(1)? / RATE_HZ,
                ["interrupt", "edge", ..] => counted.edge = number(3)?,
                ["interrupt", "transmit", "0", _] => counted.interrupt = number(3)?,
                ["interrupt", "transmit", ..] => {
                    counted.byte = (number(3)? - counted.interrupt) / number(2)?;
                }
                _ => bail!("the image said `{line}`"),
            }
        }
        ensure!(
            !counted.parts.is_empty() && counted.byte > 0.0 && counted.link_bytes > 0.0,
            "the image did not say all:\n{said}"
        );
        Ok(counted)
    }

    /// Instructions of a conversion, on average.
    fn mean(&self) -> f64 {
        self.parts.iter().map(|part| part.mean).sum()
    }

    /// Instructions from one edge to the next, at most.
    fn worst(&self) -> f64 {
        self.parts.iter().map(|part| part.worst).sum()
    }

    /// Cycles of the interrupts of a conversion: one for its edge, one for each byte.
    fn interrupt_cycles(&self, per_instruction: f64) -> f64 {
        let byte = (self.interrupt + self.byte) * per_instruction + INTERRUPT_CYCLES;
        self.edge * per_instruction + INTERRUPT_CYCLES + self.link_bytes * byte
    }

    fn show(&self) {
        let period = CORE_HZ / RATE_HZ;
        println!(
            "\ninstructions of a conversion of three axes, {RATE_HZ}/s\n{:<12}{:>8}{:>8}{:>22}",
            "", "mean", "most", "in the worst of all"
        );
        for Part {
            name,
            mean,
            most,
            worst,
        } in &self.parts
        {
            println!("{name:<12}{mean:>8.0}{most:>8.0}{worst:>22.0}");
        }
        println!("{:<12}{:>8.0}{:>30.0}", "sum", self.mean(), self.worst());
        for (name, mean, most) in &self.alone {
            println!("{name:<12}{mean:>8.0}{most:>8.0}  alone");
        }
        println!(
            "interrupts: edge {:.0}, byte sent {:.0}, {:.1} bytes a conversion",
            self.edge,
            self.interrupt + self.byte,
            self.link_bytes
        );
        let share = |cycles: f64| 100.0 * cycles / period;
        println!(
            "of {period:.0} cycles at {CYCLES_PER_INSTRUCTION} an instruction: work {:.0} %, \
             interrupts {:.0} %, waiting for the buses {:.0} %",
            share(self.mean() * CYCLES_PER_INSTRUCTION),
            share(self.interrupt_cycles(CYCLES_PER_INSTRUCTION)),
            share(bus_s() * CORE_HZ),
        );
    }

    /// How late the conversion behind the worst one is looked at, seconds.
    fn late_s(&self, per_instruction: f64) -> f64 {
        let cycles = self.worst() * per_instruction + self.interrupt_cycles(per_instruction);
        cycles / CORE_HZ + bus_s() - 1.0 / RATE_HZ
    }

    /// How late it may be looked at: its third word has to end before the next conversion.
    fn may_be_late_s(&self, per_instruction: f64) -> f64 {
        let words = self.parts.iter().filter(|part| part.name == "read");
        let words: f64 = words
            .map(|part| part.most * per_instruction / CORE_HZ)
            .sum();
        1.0 / RATE_HZ - bus_s() - BEFORE_NEXT_S - words
    }

    fn hold_to_the_period(&self) -> Result<()> {
        let late_s = self.late_s(CYCLES_PER_INSTRUCTION);
        let may_be_s = self.may_be_late_s(CYCLES_PER_INSTRUCTION);
        println!(
            "behind the worst one the next is looked at {:.0} us late, {:.0} us may be",
            1e6 * late_s.max(0.0),
            1e6 * may_be_s
        );
        ensure!(
            late_s < may_be_s,
            "a conversion is lost behind the worst one at {CYCLES_PER_INSTRUCTION} cycles an \
             instruction"
        );
        // Both are linear in it.
        let slack = |per: f64| self.may_be_late_s(per) - self.late_s(per);
        let most = slack(0.0) / (slack(0.0) - slack(1.0));
        println!("none is lost up to {most:.2} cycles an instruction");
        Ok(())
    }
}

/// Time that three words take on their buses.
fn bus_s() -> f64 {
    AXES * (32.0 / SPI_HZ + BEHIND_WORD_S)
}
