//! The rate of one clock by another, from readings of both that are late by what lies between them.
//!
//! Bytes come late and never early: as late as a USB adapter holds them back (up to 16 ms), now and then by
//! as much as a machine stands still. So of many readings the least late say most. The time is cut into
//! [`BLOCKS`]; of each the least late reading counts, and a line is put through them by least squares. How far
//! they lie off it is how well the way is known, whatever its law is: the interval is that of a slope, by
//! Student's distribution. Few readings count one by one.
//!
//! That spread shows nothing of a lateness that grows evenly over the whole record. A line that delivers on a grid
//! of its own (USB: every millisecond) makes one: while the board's clock drifts past the grid, all of them are
//! later and later. So the uncertainty holds a drift over a [`GRID_S`] as well, and over as much of the lateness as
//! readings have in common with those before them. What it cannot know of is a coarser grid that a record is too
//! short to drift past once.

use super::Measured;
use crate::numeric::order::median;

/// Fewest readings that give a rate and a spread to judge it by: with three degrees of freedom the spread
/// is known to within a factor of some three.
pub const FEWEST: usize = 5;

/// Stretches of time of which the least late reading counts. Fewer would have less late ones, and a spread that
/// says less of itself: between 8 and 16 the 95 % interval is nearly as wide (ten degrees of freedom).
pub(super) const BLOCKS: usize = 12;

/// Readings from which on there are blocks, each of two or more.
pub(super) const FROM: usize = 2 * BLOCKS;

/// Grid on which a line may deliver without showing it, seconds: a frame of USB. That of an adapter's timer
/// (16 ms) does not last where the board streams, since its buffers fill sooner.
const GRID_S: f64 = 1e-3;

/// Both clocks at once, in seconds since some moment of each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// The board's, when a record was made.
    pub board_s: f64,
    /// The host's, when it had arrived.
    pub host_s: f64,
}

/// A line through readings.
struct Line {
    /// Seconds of the board in one of the host.
    slope: f64,
    /// Standard uncertainty of the slope, from the spread about the line.
    sd: f64,
    /// Degrees of freedom of the spread.
    freedom: f64,
}

/// Seconds of the board's clock in one of the host's; `None` with fewer than [`FEWEST`] readings, or at one
/// moment.
pub fn ratio(pairs: &[Pair]) -> Option<Measured> {
    let all = line(pairs)?;
    let line = if pairs.len() < FROM {
        all
    } else {
        line(&least_late(pairs, all.slope))?
    };
    // Even over as much either way.
    let drift = drift_s(pairs, line.slope) / 3.0_f64.sqrt() / span_s(pairs);
    Some(Measured {
        value: line.slope,
        sd: line.sd.hypot(drift),
        freedom: line.freedom,
    })
}

/// Time from the first reading to the last, by the host.
pub(super) fn span_s(pairs: &[Pair]) -> f64 {
    match pairs {
        [first, .., last] => last.host_s - first.host_s,
        _ => 0.0,
    }
}

/// By how much later than a line of this slope through the origin.
pub(super) fn late_s(pair: &Pair, slope: f64) -> f64 {
    pair.host_s - pair.board_s / slope
}

/// By how much the lateness may have grown over the record, or fallen, without showing it.
fn drift_s(pairs: &[Pair], slope: f64) -> f64 {
    let mut late: Vec<f64> = pairs.iter().map(|pair| late_s(pair, slope)).collect();
    let least = late.iter().copied().fold(f64::INFINITY, f64::min);
    let count = late.len() as f64;
    let mean = late.iter().sum::<f64>() / count;
    let product = |two: &[f64]| (two[0] - mean) * (two[1] - mean);
    let square: f64 = late.iter().map(|late| (late - mean).powi(2)).sum();
    let shared = late.windows(2).map(product).sum::<f64>() / square;
    // Of readings that have nothing in common it comes out within two standard errors of nothing.
    let shared = (shared - 2.0 / count.sqrt()).max(0.0);
    let usual = median(&mut late).map_or(0.0, |median| median - least);
    // Most of what is even about its middle lies within twice that.
    GRID_S + 2.0 * usual * shared
}

/// The least late reading of each block.
fn least_late(pairs: &[Pair], slope: f64) -> Vec<Pair> {
    let begun_s = pairs.first().map_or(0.0, |first| first.host_s);
    let length_s = span_s(pairs) / BLOCKS as f64;
    let block = |pair: &Pair| (((pair.host_s - begun_s) / length_s) as usize).min(BLOCKS - 1);
    pairs
        .chunk_by(|one, two| block(one) == block(two))
        .filter_map(|block| {
            let late = |one: &&Pair| late_s(one, slope);
            block.iter().min_by(|a, b| late(a).total_cmp(&late(b)))
        })
        .copied()
        .collect()
}

/// Least squares.
fn line(pairs: &[Pair]) -> Option<Line> {
    if pairs.len() < FEWEST {
        return None;
    }
    let count = pairs.len() as f64;
    let mean = |of: fn(&Pair) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (host, board) = (mean(|pair| pair.host_s), mean(|pair| pair.board_s));
    let (mut square, mut product) = (0.0, 0.0);
    for pair in pairs {
        square += (pair.host_s - host).powi(2);
        product += (pair.host_s - host) * (pair.board_s - board);
    }
    let slope = product / square;
    if !(square > 0.0 && slope > 0.0) {
        return None;
    }
    let error = |pair: &Pair| pair.board_s - board - slope * (pair.host_s - host);
    let spread: f64 = pairs.iter().map(|pair| error(pair).powi(2)).sum();
    let freedom = count - 2.0;
    Some(Line {
        slope,
        sd: (spread / freedom / square).sqrt(),
        freedom,
    })
}
