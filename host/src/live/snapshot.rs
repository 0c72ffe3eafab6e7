//! The state of a recording at one moment, and its text.

use std::fmt::Write;

use inm_protocol::{AxisCounters, Health};

use crate::source::assemble::Losses;
use crate::source::audit::Proof;

/// What the view shows.
#[derive(Debug, Clone, Default)]
pub struct Snapshot {
    /// Port or file that the samples come from.
    pub source: String,
    /// Capture that they go to.
    pub capture: Option<String>,
    /// Samples a second.
    pub rate_hz: f64,
    /// Samples an axis so far, lost ones included.
    pub samples: u64,
    /// Samples an axis at the end, where that is known.
    pub expected: Option<u64>,
    /// Bytes in the capture so far.
    pub bytes: u64,
    /// Samples lost and flagged.
    pub losses: Losses,
    /// Frames that arrived damaged.
    pub damaged: u64,
    /// The board's last health record.
    pub health: Option<Health>,
    /// What the board's own bins prove.
    pub proof: Option<Proof>,
    /// Names of the axes with their unit.
    pub axes: Vec<String>,
    /// The Allan table, shortest averaging time first.
    pub table: Vec<Row>,
    /// The coefficients of the likelihood fit, once there is one.
    pub noise: Vec<NoiseRow>,
    /// The last things that happened, oldest first.
    pub news: Vec<String>,
}

/// One averaging time.
#[derive(Debug, Clone)]
pub struct Row {
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// One cell an axis; `None` where there is no estimate yet.
    pub cells: Vec<Option<Cell>>,
}

/// One coefficient.
#[derive(Debug, Clone)]
pub struct NoiseRow {
    /// Its letter.
    pub symbol: &'static str,
    /// One cell an axis; `None` where there is no fit yet.
    pub cells: Vec<Option<Noise>>,
}

/// What the record shows of a coefficient up to now.
#[derive(Debug, Clone, Copy)]
pub enum Noise {
    /// Its value, and half the width of its 95 % interval as a fraction of it.
    Value(f64, f64),
    /// Not resolved from zero; its 95 % bound.
    Below(f64),
}

/// One Allan deviation.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// Allan deviation, in the unit of the axis.
    pub adev: f64,
    /// Half the width of its 95 % interval, as a fraction of it.
    pub relative: f64,
}

/// Characters of the progress bar.
const BAR: usize = 30;

impl Snapshot {
    /// The view as lines of text.
    pub fn render(&self) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        write!(out, "{}", self.source)?;
        if let Some(capture) = &self.capture {
            write!(out, " -> {capture}")?;
        }
        writeln!(out, "   {} samples/s", self.rate_hz)?;
        self.progress(out)?;
        self.state(out)?;
        if let Some(proof) = &self.proof {
            writeln!(out, "{proof}")?;
        }
        self.allan(out)?;
        self.coefficients(out)?;
        for line in &self.news {
            writeln!(out, "! {line}")?;
        }
        Ok(())
    }

    /// How far the recording is, in a line.
    fn progress(&self, out: &mut String) -> std::fmt::Result {
        let elapsed_s = self.samples as f64 / self.rate_hz;
        match self.expected {
            Some(expected) if expected > 0 => {
                let done = (self.samples as f64 / expected as f64).min(1.0);
                let filled = (done * BAR as f64) as usize;
                write!(
                    out,
                    "{} of {}  [{:#<filled$}{:->rest$}] {:3.0} %",
                    clock(elapsed_s),
                    clock(expected as f64 / self.rate_hz),
                    "",
                    "",
                    100.0 * done,
                    rest = BAR - filled,
                )?;
            }
            _ => write!(out, "{}", clock(elapsed_s))?,
        }
        write!(out, "  {} samples an axis", self.samples)?;
        if self.bytes > 0 {
            write!(out, "  {:.1} MB", self.bytes as f64 / 1e6)?;
        }
        writeln!(out)
    }

    /// What was lost and how the board is, in a line.
    fn state(&self, out: &mut String) -> std::fmt::Result {
        let Losses {
            lost_samples,
            gaps,
            flagged: [x, y, z],
            ..
        } = self.losses;
        write!(
            out,
            "lost {lost_samples} samples in {gaps} gaps, {} damaged frames; flagged X {x} Y {y} Z {z}",
            self.damaged
        )?;
        if let Some(health) = &self.health {
            if let Some(t) = health.mcu_centi_celsius {
                write!(out, "; board {:.1} degC", f64::from(t) / 100.0)?;
            }
            if let Some(mv) = health.supply_mv {
                write!(out, ", sensor supply {:.3} V", f64::from(mv) / 1000.0)?;
            }
            let trouble: u32 = health.axes.iter().map(trouble).sum();
            if trouble > 0 {
                write!(out, ", converter trouble {trouble} times")?;
            }
        }
        writeln!(out)
    }

    /// The Allan table.
    fn allan(&self, out: &mut String) -> std::fmt::Result {
        if !self.table.is_empty() {
            writeln!(out)?;
            write!(out, "{:>11}", "tau, s")?;
            for axis in &self.axes {
                write!(out, "{axis:>22}")?;
            }
            writeln!(out)?;
        }
        for row in &self.table {
            write!(out, "{:>11}", short(row.tau_s))?;
            for cell in &row.cells {
                match cell {
                    Some(Cell { adev, relative }) => {
                        let percent = format!("{:.2} %", 100.0 * relative);
                        write!(out, "{adev:>12.3e} ±{percent:>8}")?;
                    }
                    None => write!(out, "{:>22}", "-")?,
                }
            }
            writeln!(out)?;
        }
        Ok(())
    }

    /// The coefficients, in the columns of the table.
    fn coefficients(&self, out: &mut String) -> std::fmt::Result {
        for row in &self.noise {
            write!(out, "{:>11}", row.symbol)?;
            for cell in &row.cells {
                match cell {
                    Some(Noise::Value(value, relative)) => {
                        let percent = format!("{:.2} %", 100.0 * relative);
                        write!(out, "{value:>12.3e} ±{percent:>8}")?;
                    }
                    Some(Noise::Below(bound)) => {
                        write!(out, "{:>22}", format!("below {bound:.2e}"))?;
                    }
                    None => write!(out, "{:>22}", "-")?,
                }
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

/// Times that a converter had to be reset because of something that went wrong.
fn trouble(axis: &AxisCounters) -> u32 {
    axis.slipped + axis.stuck + axis.stalled + axis.registers_lost
}

/// `hh:mm:ss`.
fn clock(seconds: f64) -> String {
    let s = seconds as u64;
    format!("{:02}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
}

/// A time to four digits without trailing zeros.
fn short(seconds: f64) -> String {
    if (0.001..1e5).contains(&seconds) {
        let digits = (3 - seconds.log10().floor() as i32).max(0) as usize;
        let text = format!("{seconds:.digits$}");
        if text.contains('.') {
            return text.trim_end_matches('0').trim_end_matches('.').to_owned();
        }
        return text;
    }
    format!("{seconds:.3e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short() {
        let shown = [0.0005, 0.001, 0.0125, 1.0, 32.768, 1234.5].map(short);
        assert_eq!(shown, ["5.000e-4", "0.001", "0.0125", "1", "32.77", "1234"]);
    }

    #[test]
    fn the_view_tells_progress_loss_and_table() {
        let snapshot = Snapshot {
            source: "virtual".into(),
            capture: Some("run.inmcap".into()),
            rate_hz: 2000.0,
            samples: 5_400_000,
            expected: Some(10_800_000),
            losses: Losses {
                lost_samples: 32,
                gaps: 1,
                ..Losses::default()
            },
            axes: vec!["X, m/s^2".into()],
            table: vec![Row {
                tau_s: 1.0,
                cells: vec![Some(Cell {
                    adev: 3.9e-4,
                    relative: 0.02,
                })],
            }],
            noise: vec![NoiseRow {
                symbol: "N",
                cells: vec![Some(Noise::Below(1.25e-4))],
            }],
            news: vec!["sample 7: X: the converter clips".into()],
            ..Snapshot::default()
        };
        let text = snapshot.render();
        assert!(text.contains("00:45:00 of 01:30:00"), "{text}");
        assert!(text.contains(" 50 %"), "{text}");
        assert!(text.contains("lost 32 samples in 1 gaps"), "{text}");
        assert!(text.contains("3.900e-4 ±  2.00 %"), "{text}");
        assert!(text.contains("N         below 1.25e-4"), "{text}");
        assert!(text.contains("! sample 7"), "{text}");
    }
}
