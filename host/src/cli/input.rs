//! Options that say what an array file holds, shared by the subcommands that read one.

use std::ops::Range;

use clap::Args;

use crate::chain::Chain;
use crate::signal::Unit;
use crate::source::options::{ArrayOptions, Decimal, Selector, TimeColumn};

/// What an array file does not say itself. Captures carry all of it.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Array files (.npy, .csv, columns of text)")]
pub struct InputOptions {
    /// Samples a second.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub rate: Option<f64>,
    /// Column of time stamps (number from 0, or name) with their unit, s, ms, us or ns, where its name does not say it; gives the rate and the gaps.
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    pub time: Option<TimeColumn>,
    /// Columns to take as axes, by number from 0 or by name; all where not given.
    #[arg(long, value_name = "COLUMN,...", value_delimiter = ',')]
    pub columns: Vec<Selector>,
    /// Unit of the scaled data: m/s^2, g, rad/s, deg/s, V or counts; needed where the names of the columns do not say it (ax_g, wx [deg/s]).
    #[arg(long)]
    pub unit: Option<Unit>,
    /// Units per count, once or one for each column.
    #[arg(
        long,
        value_name = "UNIT_PER_COUNT,...",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub scale: Vec<f64>,
    /// How fractions are written in a text file, point or comma, where its lines do not show it.
    #[arg(long)]
    pub decimal: Option<Decimal>,
    /// Leave out what lies before this time, seconds from the start.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Leave out what lies at or after this time, seconds from the start.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub to: Option<f64>,
    /// Leave out a stretch, seconds from the start of what is read; may be repeated.
    #[arg(long, value_name = "FROM:TO", value_parser = stretch)]
    pub exclude: Vec<Range<f64>>,
    /// Signal chain the data came through, such as ads1281:linear+400hz.
    #[arg(long)]
    pub chain: Option<Chain>,
}

impl From<InputOptions> for ArrayOptions {
    fn from(options: InputOptions) -> Self {
        Self {
            rate_hz: options.rate,
            time: options.time,
            decimal: options.decimal,
            columns: options.columns,
            unit: options.unit,
            scales: options.scale,
            from_s: options.from,
            to_s: options.to,
            exclude_s: options.exclude,
            chain: options.chain,
        }
    }
}

/// A stretch of time, from zero on, as it is written on the command line.
fn stretch(text: &str) -> Result<Range<f64>, String> {
    let ends = text.split_once(':');
    let ends = ends.and_then(|(from, to)| Some(from.trim().parse().ok()?..to.trim().parse().ok()?));
    ends.filter(|one: &Range<f64>| one.start >= 0.0 && one.start < one.end)
        .ok_or_else(|| {
            "expected two times in seconds, the earlier first, such as 20:31.5".to_owned()
        })
}
