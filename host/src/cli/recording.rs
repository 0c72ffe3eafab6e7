//! Options of the subcommands that talk to a board.

use std::ops::RangeInclusive;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use inm_protocol::{Filter, Phase, Rate, SensorRange, Settings};

use crate::link::{Connect, Patience, SerialConnect};
use crate::source::board::{Plan, parse_rate, parse_word};
use crate::virtual_board::VirtualConnect;

/// Which board, and how it is to record.
#[derive(Debug, Clone, Args)]
pub struct BoardOptions {
    /// Serial port of the board (`/dev/ttyUSB0`, `COM3`), or `virtual` for one without hardware.
    #[arg(long, value_name = "PORT")]
    pub source: String,

    /// Samples a second: 250, 500, 1000, 2000 (default) or 4000.
    #[arg(long, value_name = "HZ", value_parser = parse_rate)]
    pub rate: Option<Rate>,

    /// Range of the accelerometers, g: 4 or 12; the board's own where not given.
    #[arg(long, value_name = "G", value_parser = parse_range)]
    pub range: Option<SensorRange>,

    /// Converter filter: linear phase, or minimum phase for a shorter delay.
    #[arg(long, value_enum, default_value_t)]
    pub phase: PhaseArg,

    /// High-pass of the converter: its HPF word, decimal or 0x hexadecimal. Deletes drift.
    #[arg(long, value_name = "WORD", value_parser = parse_word)]
    pub high_pass: Option<u16>,

    /// Stop after this many seconds of samples.
    #[arg(long, value_name = "S", value_parser = parse_positive)]
    pub duration: Option<f64>,

    /// Speed of the serial port, bit/s.
    #[arg(long, value_name = "BIT_PER_S", default_value_t = 921_600)]
    pub baud: u32,

    /// Wait this long for a board that went away, fell silent or stopped; 0 gives up at once.
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = parse_reconnect)]
    pub reconnect: f64,

    /// Seed of the virtual board's noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// Virtual board only: seconds of board time in a second, or 0 for as fast as it goes.
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = parse_speed)]
    pub speed: Option<f64>,

    /// Virtual board only: a pulse a second at its input, with jitter, and crystals that are off; both are drawn from
    /// --seed.
    #[arg(long)]
    pub pps: bool,
}

/// Phase response of the converter's filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum PhaseArg {
    /// Symmetric impulse response.
    #[default]
    Linear,
    /// Shortest delay.
    Minimum,
}

impl BoardOptions {
    /// How to reach the board; `default_speed` is that of the virtual board.
    pub fn connect(&self, default_speed: f64) -> Box<dyn Connect> {
        if self.source == "virtual" {
            let speed = self.speed.unwrap_or(default_speed);
            let board = VirtualConnect::published(self.seed, speed);
            return Box::new(match self.pps {
                true => board.with_pulses(self.seed),
                false => board,
            });
        }
        Box::new(SerialConnect::new(self.source.as_str(), self.baud))
    }

    /// The settings that the board is to have.
    pub fn settings(&self) -> Settings {
        let rate = self.rate.unwrap_or_default();
        let phase = match self.phase {
            PhaseArg::Linear => Phase::Linear,
            PhaseArg::Minimum => Phase::Minimum,
        };
        let filter = Filter::Fir {
            phase,
            high_pass: self.high_pass,
        };
        Settings { rate, filter }
    }

    /// What to ask of the board, with these settings.
    pub fn plan(&self, settings: Settings) -> Plan {
        let rate_hz = f64::from(settings.rate.hz());
        Plan {
            settings: Some(settings),
            range: self.range,
            samples: self.duration.map(|s| (s * rate_hz).round() as u64),
            patience: Patience::default(),
            reconnect: (self.reconnect > 0.0).then(|| Duration::from_secs_f64(self.reconnect)),
        }
    }
}

/// Exit status of a recording that came to its end, but with samples missing.
const INCOMPLETE: u8 = 1;

/// Status of the process for recordings that came to their end, all of them `complete` or not.
pub fn recorded(complete: bool) -> ExitCode {
    if complete {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(INCOMPLETE)
    }
}

/// Longest wait for a board, seconds: a century, which is for ever and still a time.
const LONGEST_WAIT_S: f64 = 3.2e9;

fn parse_reconnect(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.0..=LONGEST_WAIT_S).contains(&seconds) => Ok(seconds),
        _ => Err("a number of seconds from 0 to 3.2e9 is expected".to_owned()),
    }
}

/// Seconds of a record in a second that one can wait for, or that are no different from none.
const SPEED: RangeInclusive<f64> = 1e-6..=1e6;

/// How fast a record is played: seconds of it in a second, 0 for as fast as it goes.
///
/// # Errors
/// In words, if it is neither 0 nor from 1e-6 to 1e6.
pub fn parse_speed(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(speed) if speed == 0.0 || SPEED.contains(&speed) => Ok(speed),
        _ => Err("a factor from 1e-6 to 1e6 is expected, or 0 for as fast as it goes".to_owned()),
    }
}

/// A range of the accelerometers, g.
///
/// # Errors
/// In words, if the sensors do not have it.
pub fn parse_range(text: &str) -> Result<SensorRange, String> {
    match text {
        "4" => Ok(SensorRange::G4),
        "12" => Ok(SensorRange::G12),
        _ => Err("the accelerometers have 4 and 12 g".to_owned()),
    }
}

/// A length of time, seconds.
///
/// # Errors
/// In words, if it is no number above zero.
pub fn parse_positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if f64::is_finite(seconds) && seconds > 0.0 => Ok(seconds),
        _ => Err("a positive number of seconds is expected".to_owned()),
    }
}
