//! Samples lost without a trace: every line's phase jumps at one moment, by what it would have
//! turned in the samples that are missing.
//!
//! A line of frequency `f` runs on by `2 pi f d / rate` where `d` samples are lost. All lines are
//! looked at together for one moment `t` and one whole number `d`; each has its own amplitude,
//! phase and small offset in frequency, with the loss as without it. `G(t, d)` is the gain in
//! log-likelihood over steady lines (S. M. Kay, *Fundamentals of Statistical Signal Processing* II,
//! 1998, ch. 6).
//!
//! **Level.** The likelihood ratio averaged over all `n` moments and lengths tried, each with the
//! same weight, `m = (1/n) sum e^G`, has mean 1 without a loss, so that `1 / m` bounds the
//! probability of as much (A. A. Markov's inequality). It counts the trials by itself; amplitudes
//! and offsets are fitted on both sides of the ratio.

use rustfft::num_complex::Complex64;

use super::demodulate::Blocks;
use super::evidence::{AROUND_LINE, Case};
use super::lengths::{looked, smallest_of_the_best};
use super::line::{LINE_REACH, Line, cleaned};
use super::loss::Loss;
use super::moment::Quiet;
use super::peaks::{self, Place};
use crate::diagnosis::axis::AxisState;
use crate::spectrum::Line as Peak;

/// Blocks that a record is cut into, at most and at least. The tables hold every block times every
/// number lost, so that more cost time; a moment is followed to the sample afterwards. Of fewer the
/// noise would be the median of less than 30 ordinates. Both are choices.
const BLOCKS: usize = 512;
const FEWEST_BLOCKS: usize = 40;

/// Cycles of a line in a block, at least: of fewer the block's straight line takes more than 4 % of the energy.
/// Mains that are too slow for that leave their multiples alone with a loss, each with the skirts of the others: a
/// record of 5 s has but 250 cycles of them.
const CYCLES: f64 = 4.0;

/// Samples lost that are looked for, at most: as many as the slowest line has to a cycle, but
/// within these, which are choices: the time grows with the number.
const LONGEST: [f64; 2] = [64.0, 256.0];

/// Log-likelihood that a line gains, at least, to be one: at a given frequency noise does as well
/// once in 3000 times.
const LEAST_LINE: f64 = 8.0;

/// Lines that are looked at, at most, the strongest: a choice, for each costs a table.
const MOST_LINES: usize = 16;

/// Times that the lines are freed of one another: a choice. The second sees the noise that the
/// first had lowered.
const CLEANINGS: usize = 2;

/// Looks for samples lost in an axis at a family-wise `level`, by the lines `found` and what else
/// there is at multiples of a mains frequency among them; the side lobes into which a jump splits
/// a line count as one with it. `None` without two lines.
pub fn lost_samples(axis: &AxisState, found: &[Peak], level: f64) -> Option<Loss> {
    let values = &axis.filled;
    let peaks = peaks::merged(found, axis.rate_hz, values.len());
    let places = peaks::with_harmonics(peaks, axis.rate_hz, values.len());
    if places.len() < 2 {
        return None;
    }
    let usable = |index: usize| axis.usable(index);
    let quiet = quiet(axis, values, &places);
    search(values, &quiet, &places, level, usable)
}

/// The record with loud noise brought down to what is under the lines.
fn quiet<'a>(axis: &AxisState, whole: &'a [f64], places: &[Place]) -> Quiet<'a> {
    let least = places
        .iter()
        .map(|place| axis.density(place.cycles * axis.rate_hz))
        .fold(f64::INFINITY, f64::min);
    let seen = axis.whitened();
    let (transform, density) = (&seen.transform, &seen.density);
    let mut values = transform.filtered(|k| Complex64::new((least / density[k]).min(1.0), 0.0));
    for (index, value) in values.iter_mut().enumerate() {
        if !axis.usable(index) {
            *value = 0.0;
        }
    }
    Quiet {
        whole,
        values,
        variance: least * axis.rate_hz,
    }
}

/// [`lost_samples`] in a plain series.
fn search(
    values: &[f64],
    quiet: &Quiet<'_>,
    places: &[Place],
    level: f64,
    usable: impl Fn(usize) -> bool,
) -> Option<Loss> {
    // The slowest line decides how fine the blocks are; what is slower than any allows is left.
    let places: Vec<&Place> = places
        .iter()
        .filter(|place| {
            place.cycles * values.len() as f64 >= CYCLES * FEWEST_BLOCKS as f64
                && place.cycles < 0.5
        })
        .collect();
    let slowest = places
        .iter()
        .map(|place| place.cycles)
        .min_by(f64::total_cmp)?;
    let count = ((slowest * values.len() as f64 / CYCLES) as usize).min(BLOCKS);
    let blocks = Blocks::new(values, count, usable);
    let mut lines = separate(&blocks, &places, values.len());
    if lines.len() < 2 {
        return None;
    }
    let longest = (1.0 / slowest).clamp(LONGEST[0], LONGEST[1]) as usize;
    let (mut tables, mut found) = looked(&blocks, quiet, &lines, longest);
    // A strong line that jumps is noise to the others and, by its skirts, to itself: each is looked
    // at again without the rest, against the noise that all of them leave.
    for _ in 0..CLEANINGS {
        let (chosen, ..) = smallest_of_the_best(&found)?;
        if found[chosen].nats(&lines) < LEAST_LINE {
            return None;
        }
        let chosen = &found[chosen];
        lines = cleaned(&blocks, &lines, &chosen.turned, chosen.index());
        (tables, found) = looked(&blocks, quiet, &lines, longest);
    }
    let case = Case {
        blocks: &blocks,
        lines: &lines,
        longest,
        tables: &tables,
        found: &found,
    };
    case.judged(level)
}

/// Lines at these places that are strong enough and stand by themselves, the strongest first; the record has
/// `length` samples.
fn separate(blocks: &Blocks, places: &[&Place], length: usize) -> Vec<Line> {
    let lines = places.iter().map(|place| {
        Line::new(
            blocks.at(place.cycles),
            0.5 * place.width + 2.0 * LINE_REACH,
        )
    });
    let mut lines: Vec<Line> = lines.filter(|line| line.gain > LEAST_LINE).collect();
    lines.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut separate: Vec<Line> = Vec::new();
    for line in lines {
        let place = |line: &Line| line.cycles(line.offset, blocks.len) * length as f64;
        let alone = |other: &Line| (place(other) - place(&line)).abs() > AROUND_LINE as f64;
        if separate.iter().all(alone) {
            separate.push(line);
        }
    }
    separate.truncate(MOST_LINES);
    separate
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
