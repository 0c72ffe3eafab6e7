//! `inm board info`: what a board is.

use std::fmt::Write as _;
use std::process::ExitCode;

use clap::Args;
use inm_protocol::{AxisCounters, Filter, Phase, SensorRange};

use super::JsonOption;
use super::which::Which;
use crate::capture::ClockSource;
use crate::inspect::info::{AxisInfo, Info, PulseInfo, State};
use crate::source::SourceError;

/// Arguments of `inm board info`.
#[derive(Debug, Args)]
pub struct InfoCommand {
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    json: JsonOption,
}

impl InfoCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the port or the board says.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        self.json.check()?;
        let mut found = self.which.find()?;
        let info = Info::ask(found.port, &mut found.session, &found.identity);
        let info = info.map_err(SourceError::from)?;
        self.json.write(&info, &text(&info))?;
        Ok(ExitCode::SUCCESS)
    }
}

/// The board in lines of a name and what it is.
fn text(info: &Info) -> String {
    let mut text = String::new();
    let mut line = |name: &str, what: String| {
        let _ = writeln!(text, "{name:<11} {what}");
    };
    line("board", format!("{} on {}", info.serial, info.port));
    line(
        "firmware",
        format!(
            "{} for {}, protocol {}; this program is {}",
            info.firmware, info.platform, info.protocol, info.program
        ),
    );
    line("started", info.restart_words.clone());
    line(
        "clock",
        format!(
            "{}, stamps of {} ticks/s, converters at {} Hz",
            clock(info.clock),
            info.timer_hz,
            info.converter_clock_hz
        ),
    );
    if let Some(pulse) = &info.pulse {
        line("pulse", pulse_words(pulse));
    }
    line("line", format!("{} bit/s", info.baud));
    let range = match info.range {
        SensorRange::G4 => "4 g",
        SensorRange::G12 => "12 g",
    };
    line(
        "sensors",
        format!(
            "range {range}, nominal supply {} V; reference of the converters {} V",
            info.sensor_supply_v, info.reference_v
        ),
    );
    line(
        "settings",
        format!(
            "{} samples/s, {}",
            info.settings.rate.hz(),
            filter(info.settings.filter)
        ),
    );
    match &info.state {
        Some(state) => state_lines(state, &mut line),
        None => line("state", "unknown: no health record came".to_owned()),
    }
    if let Some(refused) = &info.registers_refused {
        line("registers", refused.clone());
    }
    for axis in &info.axes {
        line(&format!("axis {}", axis.name), axis_words(axis));
    }
    text
}

fn clock(source: ClockSource) -> &'static str {
    match source {
        ClockSource::Crystal => "crystal",
        ClockSource::Internal => "INTERNAL OSCILLATOR, good to 1 %: its crystal did not start",
        ClockSource::Emulated => "emulated",
        ClockSource::Unknown => "unknown",
    }
}

fn pulse_words(pulse: &PulseInfo) -> String {
    let counters = pulse.counters;
    format!(
        "one a second: {} since it started, seconds without {}, doubled {}, no whole second apart {}, other edges {}",
        pulse.number, counters.missing, counters.doubled, counters.odd, counters.early
    )
}

fn filter(filter: Filter) -> String {
    let Filter::Fir { phase, high_pass } = filter else {
        return format!("{filter:?}");
    };
    let phase = match phase {
        Phase::Linear => "linear phase",
        Phase::Minimum => "minimum phase",
    };
    match high_pass {
        Some(word) => format!("{phase}, high-pass of word {word:04X}h"),
        None => format!("{phase}, no high-pass"),
    }
}

fn state_lines(state: &State, line: &mut impl FnMut(&str, String)) {
    let streams = if state.streaming {
        "streaming"
    } else {
        "at rest"
    };
    let mut words = format!("{streams}, up for {:.1} s", state.up_s);
    if let Some(celsius) = state.mcu_celsius {
        let _ = write!(words, ", microcontroller {celsius:.2} degC");
    }
    if let Some(volts) = state.supply_v {
        let _ = write!(words, ", sensors' supply {volts:.3} V");
    }
    if state.stack_size > 0 {
        let _ = write!(
            words,
            ", stack {} of {} bytes",
            state.stack_used, state.stack_size
        );
    }
    line("state", words);
    let troubles = state.axes.iter().map(resets_and_words);
    let [resets, words] = troubles.fold([0, 0], |[resets, words], [more, bad]| {
        [resets + more, words + bad]
    });
    let link = &state.link;
    line(
        "trouble",
        format!(
            "converters {resets} resets for cause and {words} bad words, line {} frames dropped and {} \
             damaged (`inm board log` says more)",
            link.frames_dropped, link.frames_bad
        ),
    );
}

/// Resets of an axis because of trouble, and words of it that were flagged.
fn resets_and_words(axis: &AxisCounters) -> [u64; 2] {
    let words = [axis.over_range, axis.torn, axis.missed].map(u64::from);
    // Every start resets the converters: only those with a reason count.
    let reasons = [axis.slipped, axis.stuck, axis.stalled, axis.registers_lost];
    [reasons.map(u64::from).iter().sum(), words.iter().sum()]
}

fn axis_words(axis: &AxisInfo) -> String {
    let mut words = axis.converter_id.map_or_else(
        || "no converter has answered".to_owned(),
        |id| format!("converter {id:02X}h"),
    );
    if let Some(calibration) = axis.calibration {
        let _ = match calibration.offset == 0 && calibration.gain == 1.0 {
            true => write!(words, ", not calibrated"),
            false => write!(
                words,
                ", calibrated: offset {} counts of 24 bits, gain {:.6}",
                calibration.offset, calibration.gain
            ),
        };
    }
    if let Some(registers) = axis.registers {
        let bytes = registers.map(|byte| format!("{byte:02X}"));
        let _ = write!(words, ", registers 00h to 0Ah: {}", bytes.join(" "));
    }
    words
}
