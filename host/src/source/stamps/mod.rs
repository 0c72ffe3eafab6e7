//! Time stamps of a file: the rate that they give, the gaps, and whether they can mean what they say.

use super::grid::{self, Grid, NoGrid};
use super::header;
use super::options::{ArrayOptions, TimeUnit};
use super::table::Table;
use super::{SourceError, Values};
use crate::signal::{POSSIBLE_RATE, POSSIBLE_RATE_HZ};

/// Rows read at a time: some hundred kilobytes, whatever the length of the file.
const ROWS: usize = 8192;

/// Rates that seconds are taken for where nothing says that they are, samples a second. A sensor of
/// motion is read faster than the one, and milliseconds read as seconds are slower at all its rates to
/// 10 000/s; no channel of noise is as fast as the other.
const BELIEVED_HZ: std::ops::Range<f64> = 10.0..100_000.0;

/// Rates that a unit in the name of the column is believed at, samples a second.
const POSSIBLE_HZ: std::ops::Range<f64> = 1e-3..1e7;

/// Part that `--rate` may differ from the rate of the stamps: more than clocks differ by that are
/// called the same, less than any two rates that a sensor offers.
const SAME_RATE: f64 = 0.02;

/// Part of a rate below which nothing is said of a difference: what a crystal is off by.
const CLOCK: f64 = 1e-4;

/// Digits of the rate that stamps in doubles can give.
const DIGITS: i32 = 12;

/// Samples that can be missing: with more, an index is no exact `f64` any more.
const MOST_LOST: u64 = 1 << 53;

/// Counters of 32 bits start again after so many.
const WRAP: f64 = 4_294_967_296.0;

/// What the stamps of a file say.
#[derive(Debug, Clone, PartialEq)]
pub struct Stamps {
    /// Samples a second.
    pub rate_hz: f64,
    /// Where the rows lie: first row of a run without a gap, and its index.
    pub runs: Vec<(u64, u64)>,
    /// Rows in all.
    pub rows: u64,
    /// Index behind the last row.
    pub end: u64,
    /// What was taken for granted, in words.
    pub notes: Vec<String>,
}

/// Reads the stamps in `column` of `table`, which is read for nothing else.
///
/// # Errors
/// If they run backwards, follow no grid, or cannot mean what they say.
pub fn read(
    mut table: Box<dyn Table>,
    column: usize,
    unit: Option<TimeUnit>,
    options: &ArrayOptions,
) -> Result<Stamps, SourceError> {
    table.select(&[column])?;
    let mut notes = Vec::new();
    let times = times(&mut *table, &mut notes)?;
    let bad = |message: String, remedy: String| SourceError {
        place: table.name().to_owned(),
        message,
        remedy,
    };
    let grid = grid::fit(&times).map_err(|error| {
        let (message, remedy) = no_grid(error);
        bad(message, remedy)
    })?;
    let name = table.header().map(|names| names[column].clone());
    let column = Column {
        called: name.clone().unwrap_or_else(|| column.to_string()),
        said: name.as_deref().and_then(header::time_unit),
        period: grid.period,
        rows: times.len(),
    };
    let unit = column
        .unit(unit, &mut notes)
        .map_err(|(message, remedy)| bad(message, remedy))?;
    let rate_hz = rounded(unit.per_second() / grid.period);
    // Stamps as far apart as numbers go have no rate, and NaN is none.
    if !POSSIBLE_RATE_HZ.contains(&rate_hz) {
        return Err(bad(
            format!("the time stamps give {rate_hz:?} samples a second; expected {POSSIBLE_RATE}"),
            "correct the stamps, or give --rate HZ in place of --time".into(),
        ));
    }
    let rate_hz = agreed(rate_hz, options.rate_hz, &mut notes)
        .map_err(|(message, remedy)| bad(message, remedy))?;
    let runs = runs(&grid).map_err(|(message, remedy)| bad(message, remedy))?;
    let lost = runs.last().map_or(0, |(row, place)| place - row);
    Ok(Stamps {
        rate_hz,
        runs,
        rows: times.len() as u64,
        end: times.len() as u64 + lost,
        notes,
    })
}

/// What is wrong with stamps that follow no grid, and the remedy.
fn no_grid(error: NoGrid) -> (String, String) {
    match error {
        NoGrid::TooFew => (
            "one row gives no sampling rate".into(),
            "give --rate HZ in place of --time".into(),
        ),
        NoGrid::StandStill => (
            "the time stamps stand still".into(),
            "give --rate HZ in place of --time".into(),
        ),
        NoGrid::Crowded(row) => (
            format!("about row {row} there are more rows than their time stamps have room for"),
            "delete rows that are there twice; if the stamps are no times of sampling, give --rate \
             HZ in place of --time"
                .into(),
        ),
    }
}

/// The row and the place on the grid at which each stretch without a loss begins; between the last two lies what was
/// lost in all.
fn runs(grid: &Grid) -> Result<Vec<(u64, u64)>, (String, String)> {
    let mut lost = 0_u64;
    let mut runs = vec![(0, 0)];
    for loss in &grid.losses {
        lost = lost.saturating_add(loss.samples);
        if lost > MOST_LOST {
            return Err((
                format!(
                    "the time stamps jump ahead of row {} by more samples than a record can hold",
                    loss.row
                ),
                "correct the stamp, or delete the rows behind it".into(),
            ));
        }
        runs.push((loss.row as u64, loss.row as u64 + lost));
    }
    Ok(runs)
}

/// All stamps, which do not run backwards.
fn times(table: &mut dyn Table, notes: &mut Vec<String>) -> Result<Vec<f64>, SourceError> {
    let mut times: Vec<f64> = Vec::new();
    let mut wrapped = 0.0;
    loop {
        let batch = table.read(ROWS)?;
        let Some(batch) = batch.last().filter(|batch| !batch.is_empty()) else {
            return Ok(times);
        };
        for time in floats(batch) {
            let place = || table.place(times.len() as u64);
            let remedy = "sort or repair the rows, or leave --time out and give --rate";
            if !time.is_finite() {
                return Err(SourceError {
                    place: place(),
                    message: format!("time stamp {time}; expected a number"),
                    remedy: remedy.into(),
                });
            }
            let last = times
                .last()
                .map_or(f64::NEG_INFINITY, |last| last - wrapped);
            if time < last {
                // More than half of what such a counter holds: it began again.
                if !(last < WRAP && last - time > WRAP / 2.0) {
                    return Err(SourceError {
                        place: place(),
                        message: format!("time {time} lies before {last} in the row before"),
                        remedy: remedy.into(),
                    });
                }
                wrapped += WRAP;
                notes.push(format!("{}: the counter of 32 bits began again", place()));
            }
            times.push(time + wrapped);
        }
    }
}

fn floats(values: &Values) -> Vec<f64> {
    match values {
        Values::Floats(floats) => floats.clone(),
        Values::Codes(codes) => codes.iter().copied().map(f64::from).collect(),
    }
}

/// A column of stamps, for what it may mean.
struct Column {
    /// Name, or number.
    called: String,
    /// The unit in its name.
    said: Option<TimeUnit>,
    /// Data period in its own unit.
    period: f64,
    rows: usize,
}

impl Column {
    /// Its unit: as given, else as its name says, else seconds where they can be meant. The error is
    /// message and remedy.
    fn unit(
        &self,
        given: Option<TimeUnit>,
        notes: &mut Vec<String>,
    ) -> Result<TimeUnit, (String, String)> {
        if let Some(unit) = given {
            return Ok(unit);
        }
        let rate_hz = |unit: TimeUnit| unit.per_second() / self.period;
        let (unit, believed, why) = match self.said {
            Some(unit) => (unit, POSSIBLE_HZ, "as its name says"),
            None => (TimeUnit::Seconds, BELIEVED_HZ, "as nothing says otherwise"),
        };
        if believed.contains(&rate_hz(unit)) {
            notes.push(format!(
                "column {} is the time in {}, {why}",
                self.called,
                unit.symbol()
            ));
            return Ok(unit);
        }
        let offer = |unit: &TimeUnit| {
            let symbol = unit.symbol();
            format!(
                "--time {}:{symbol} ({}/s)",
                self.called,
                shown(rate_hz(*unit))
            )
        };
        let likely = TimeUnit::ALL
            .iter()
            .filter(|unit| BELIEVED_HZ.contains(&rate_hz(**unit)));
        let offers: Vec<String> = likely.chain([&unit]).map(offer).collect();
        Err((
            format!(
                "column {} in {} would mean {} samples a second over {} s, which is hardly meant",
                self.called,
                unit.symbol(),
                shown(rate_hz(unit)),
                shown(self.rows as f64 / rate_hz(unit)),
            ),
            format!("say the unit: {}", offers.join(", or ")),
        ))
    }
}

/// The rate to go by, where the stamps give `stamped_hz` and the user `given_hz`.
fn agreed(
    stamped_hz: f64,
    given_hz: Option<f64>,
    notes: &mut Vec<String>,
) -> Result<f64, (String, String)> {
    let Some(given_hz) = given_hz else {
        return Ok(stamped_hz);
    };
    let off = given_hz / stamped_hz - 1.0;
    if off.abs() > SAME_RATE {
        return Err((
            format!(
                "--rate {given_hz} contradicts the time stamps, which give {}/s",
                shown(stamped_hz)
            ),
            "leave --rate out, or say the unit of the stamps: --time COLUMN:s, ms, us or ns".into(),
        ));
    }
    if off.abs() > CLOCK {
        notes.push(format!(
            "the time stamps give {}/s; taken is --rate {given_hz}",
            shown(stamped_hz)
        ));
    }
    Ok(given_hz)
}

/// To [`DIGITS`], so that a rate that is round is not spoilt by the rounding of sums.
fn rounded(rate_hz: f64) -> f64 {
    let digits = DIGITS as usize - 1;
    format!("{rate_hz:.digits$e}").parse().unwrap_or(rate_hz)
}

/// Six digits, for people.
fn shown(value: f64) -> String {
    let text = format!("{value:.5e}").parse().unwrap_or(value);
    if (1e-3..1e7).contains(&value) {
        format!("{text}")
    } else {
        format!("{text:e}")
    }
}

#[cfg(test)]
mod tests;
