//! The grid of data periods that the time stamps of a record follow: its period from all of them, and
//! the samples that are missing.
//!
//! Stamps are the truth plus delays: jitter, rounding, the bursts of a FIFO. A period gives the places
//! of the rows ([`place`]), the places give the period by regression, and so on until both stay. How
//! many rows a delay may last is not known, so the shortest that contradicts nothing is taken.

mod least;
mod place;

pub use place::Loss;
use place::place;

/// Steps within this fraction of their median count as regular.
const REGULAR: f64 = 0.5;

/// Share of regular steps from which their mean is a first guess at the period: with fewer, the rows
/// come in bursts and the median step is that within a burst.
const MOSTLY_REGULAR: f64 = 0.9;

/// Rounds of placing and regression. Each at least halves the error that a gap leaves in the first guess,
/// a few percent, and below a thousandth the places stay; most records need two.
const MOST_ROUNDS: usize = 12;

/// Rounds after which the number of losses stays if the window is long enough.
const SETTLING: usize = 3;

/// Share of the record that the longest delay may last: beyond, nothing tells delay from loss.
const LONGEST_DELAY: usize = 8;

/// Period of the stamps' own steps beyond which they are coarse: rounding then beats with the sampling
/// and moves a row by as much as a loss does.
const COARSE: f64 = 0.5;

/// Periods by which the line through rounded stamps may lie askew.
const ROUNDED: f64 = 0.1;

/// Share of samples that a record lacks now and then at most: beyond, it is taken for another rate.
const MOST_LOST: f64 = 0.05;

/// Stamps that are the same now and then are rounded if they are so this often at one distance; fewer can
/// be rows that are there twice.
const BEATS: f64 = 3.0;

/// Windows beyond the first that contradicts nothing that are tried for a grid that lacks less: delays that
/// follow a pattern pass for losses in a short one. Over more, a clock that wanders hides losses.
const LONGER: usize = 2;

/// A grid that lacks less than another by one part in so many is no better: it counts a gap a little
/// shorter and tilts to it.
const FEWER: u64 = 10;

/// Rows of the beginning that a window must get along with before all rows are tried: some milliseconds
/// of work.
const BEGINNING: usize = 65_536;

/// What a run of stamps says.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The data period, in the unit of the stamps.
    pub period: f64,
    /// What is missing, by ascending row.
    pub losses: Vec<Loss>,
}

/// Why stamps are on no grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoGrid {
    /// Fewer than two.
    TooFew,
    /// All the same.
    StandStill,
    /// From about this row on there are more rows than time.
    Crowded(usize),
}

/// The grid of `times`, which never run backwards.
///
/// # Errors
/// If there is none.
pub fn fit(times: &[f64]) -> Result<Grid, NoGrid> {
    let [first, .., last] = times else {
        return Err(NoGrid::TooFew);
    };
    if last <= first {
        return Err(NoGrid::StandStill);
    }
    let even = slope(times, &[]);
    let step = resolution(times);
    let coarse = step > COARSE * even;
    let rounded = coarse && fits(times, even, step);
    let coarse = coarse && moves_rows(even, step);
    if coarse && rounded {
        return Ok(without_losses(even));
    }
    let guesses = [regular(times), Some(even), lagged(times)];
    let is_regular = guesses[0].is_some();
    let (mut best, mut crowded): (Option<(u64, Grid)>, Option<usize>) = (None, None);
    for guess in guesses.into_iter().flatten() {
        for settled in settle_all(times, guess, coarse) {
            match settled {
                Settled::Grid(lost, grid) => {
                    let is_better = |(least, _): &(u64, Grid)| lost < least - least / FEWER;
                    if best.as_ref().is_none_or(is_better) {
                        best = Some((lost, grid));
                    }
                }
                // Among regular rows, the first that has no room is the one that is too much.
                Settled::Crowded(row) if crowded.is_none() || !is_regular => crowded = Some(row),
                _ => {}
            }
        }
        if best.as_ref().is_some_and(|(lost, _)| *lost == 0) {
            break;
        }
    }
    match best {
        Some((_, grid)) => Ok(grid),
        None if rounded && beats(times.len(), even, step) >= BEATS => Ok(without_losses(even)),
        None => Err(NoGrid::Crowded(crowded.unwrap_or(0))),
    }
}

fn without_losses(period: f64) -> Grid {
    Grid {
        period,
        losses: Vec::new(),
    }
}

/// What comes of each window, shortest first: up to the second that is longer than the first that
/// contradicts nothing, or of all where the stamps are `coarse`.
fn settle_all(times: &[f64], guess: f64, coarse: bool) -> Vec<Settled> {
    let longest = (times.len() / LONGEST_DELAY).max(1);
    let beginning = &times[..times.len().min(BEGINNING)];
    let windows = std::iter::successors(Some(1), |one| Some(2 * one));
    let (mut all, mut found) = (Vec::new(), 0);
    for window in windows.take_while(|&window| window <= longest) {
        // What contradicts its beginning contradicts a long record.
        let is_short = beginning.len() == times.len() || window > BEGINNING / LONGEST_DELAY;
        let settled = match is_short {
            true => settle(times, guess, window),
            false => match settle(beginning, guess, window) {
                Settled::Grid(..) => settle(times, guess, window),
                other => other,
            },
        };
        let lost = match &settled {
            Settled::Grid(lost, _) => Some(*lost),
            _ => None,
        };
        all.push(settled);
        found += usize::from(lost.is_some() || found > 0);
        if lost == Some(0) || (found > LONGER && !coarse) {
            break;
        }
    }
    all
}

/// What came of placing and regression by turns.
enum Settled {
    /// A grid, and how many samples it lacks where every window sees them.
    Grid(u64, Grid),
    Crowded(usize),
    Not,
}

fn settle(times: &[f64], guess: f64, window: usize) -> Settled {
    let mut period = guess;
    let mut seen: Vec<Vec<Loss>> = Vec::new();
    for _ in 0..MOST_ROUNDS {
        let placing = place(times, period, window);
        if seen.last() == Some(&placing.losses) {
            return match placing.crowded {
                Some(row) => Settled::Crowded(row),
                None => {
                    let seen = times.len() - (times.len() / LONGEST_DELAY).max(1);
                    let lost = placing.losses.iter().filter(|loss| loss.row <= seen);
                    // Stamps that jump as far as numbers go: who counts them refuses them.
                    let lost = lost.fold(0_u64, |sum, loss| sum.saturating_add(loss.samples));
                    let losses = placing.losses;
                    Settled::Grid(lost, Grid { period, losses })
                }
            };
        }
        period = slope(times, &placing.losses);
        let is_restless = |last: &Vec<Loss>| last.len() != placing.losses.len();
        if let Some(row) = placing.crowded.filter(|_| seen.len() >= SETTLING)
            && seen.last().is_some_and(is_restless)
        {
            return Settled::Crowded(row);
        }
        if period <= 0.0 || seen.contains(&placing.losses) {
            break;
        }
        seen.push(placing.losses);
    }
    Settled::Not
}

/// Index of every row, given what is missing.
fn indices(rows: usize, losses: &[Loss]) -> impl Iterator<Item = f64> {
    let mut coming = losses.iter().peekable();
    let mut lost = 0.0;
    (0..rows).map(move |row| {
        while let Some(loss) = coming.next_if(|loss| loss.row <= row) {
            lost += loss.samples as f64;
        }
        row as f64 + lost
    })
}

/// Least squares of the stamps on the index.
fn slope(times: &[f64], losses: &[Loss]) -> f64 {
    let rows = times.len() as f64;
    let mean_time = times.iter().map(|time| time - times[0]).sum::<f64>() / rows;
    let mean_index = indices(times.len(), losses).sum::<f64>() / rows;
    let (mut over, mut under) = (0.0, 0.0);
    for (time, index) in times.iter().zip(indices(times.len(), losses)) {
        let index = index - mean_index;
        over += index * (time - times[0] - mean_time);
        under += index * index;
    }
    over / under
}

/// How far the stamps lie from an even grid of `period`, from least to most, in periods.
fn spread(times: &[f64], period: f64) -> f64 {
    let late = |(row, time): (usize, &f64)| (time - times[0]) / period - row as f64;
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for late in times.iter().enumerate().map(late) {
        (least, most) = (least.min(late), most.max(late));
    }
    most - least
}

/// Mean of the regular steps, where most are.
fn regular(times: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let all = steps.len() as f64;
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    steps.retain(|step| (step - median).abs() <= REGULAR * median);
    let count = steps.len() as f64;
    (median > 0.0 && count >= MOSTLY_REGULAR * all).then(|| steps.iter().sum::<f64>() / count)
}

/// Median slope over an eighth of the record: a gap, however long, spoils a quarter of them at most.
fn lagged(times: &[f64]) -> Option<f64> {
    let lag = (times.len() / 8).max(1);
    let mut slopes: Vec<f64> = times
        .windows(lag + 1)
        .map(|part| (part[lag] - part[0]) / lag as f64)
        .collect();
    let middle = slopes.len() / 2;
    let median = *slopes.select_nth_unstable_by(middle, f64::total_cmp).1;
    (median > 0.0).then_some(median)
}

/// Whether an even grid of `period` and rounding to whole `step`s are all that there is in the stamps.
fn fits(times: &[f64], period: f64, step: f64) -> bool {
    spread(times, period) < step / period + ROUNDED
}

/// Whether it is rounding to `step`s that moves rows, rather than losses.
///
/// Stamps that jump by a step now and then are rounded, or samples are missing now and then: both fit.
/// Of stamps that count whole units, as the clock of a processor does, rounding is believed. Of
/// fractions, which somebody made of a count of samples, only where the steps are no whole part of the
/// period: too many samples would be missing.
fn moves_rows(period: f64, step: f64) -> bool {
    let ratio = (period / step).max(step / period);
    step >= 1.0 || (ratio / ratio.round() - 1.0).abs() >= MOST_LOST
}

/// How often rounding shows in so many rows.
fn beats(rows: usize, period: f64, step: f64) -> f64 {
    let ratio = (period / step).max(step / period);
    (ratio - ratio.round()).abs() * rows as f64 * (period / step).min(1.0)
}

/// The decimal place that all stamps are whole multiples of; zero where it is beyond the ninth.
fn resolution(times: &[f64]) -> f64 {
    let is_whole = |unit: f64| {
        times.iter().all(|time| {
            let steps = time / unit;
            (steps - steps.round()).abs() <= 1e-3 && steps.abs() < 1e15
        })
    };
    (0..=9)
        .map(|place| 10_f64.powi(-place))
        .find(|&unit| is_whole(unit))
        .unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
