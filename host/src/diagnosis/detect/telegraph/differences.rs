//! Jumps in differences of neighbouring means: far beyond the noise, they need no law of it.

use std::ops::Range;

use crate::diagnosis::statistic::spread::middle_spread;

/// Spreads of the differences beyond which one is a jump's or part of one: normal noise passes this once in 4e11.
const BEYOND: f64 = 7.0;

/// Share of a jump that shows at its middle at least where windows are full: what marks how far it shows.
const PLATEAU: f64 = 0.8;

/// Sums of a record from its begin, over the samples that it has.
pub struct Sums {
    sums: Vec<f64>,
    counts: Vec<usize>,
}

/// A jump as differences show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// First sample after it, about.
    pub index: usize,
    /// The largest difference.
    pub height: f64,
}

/// Means over some samples after each moment less those over as many before it, a pause between.
pub struct Differences {
    /// One a sample; NaN where nothing was measured on either side.
    all: Vec<f64>,
    /// Their spread, which jumps do not decide; not less than that of rounding.
    pub spread: f64,
    /// Samples over which each reaches to either side.
    pub reach: usize,
}

impl Sums {
    /// Of values that are NaN where there are none.
    pub fn new(values: &[f64]) -> Self {
        let (mut sums, mut counts) = (vec![0.0], vec![0]);
        let (mut sum, mut count) = (0.0, 0);
        for value in values {
            if value.is_finite() {
                sum += value;
                count += 1;
            }
            sums.push(sum);
            counts.push(count);
        }
        Self { sums, counts }
    }

    /// Samples there are room for.
    pub fn len(&self) -> usize {
        self.sums.len() - 1
    }

    /// Mean of those samples of a range that are there; `None` where none is.
    pub fn mean(&self, range: Range<usize>) -> Option<f64> {
        let count = self.counts[range.end] - self.counts[range.start];
        (count > 0).then(|| (self.sums[range.end] - self.sums[range.start]) / count as f64)
    }

    /// How many samples of a range are there.
    pub fn count(&self, range: Range<usize>) -> usize {
        self.counts[range.end] - self.counts[range.start]
    }
}

impl Differences {
    /// Of means over `samples` of values that are rounded so that two of them differ by `rounding`, as a standard deviation.
    pub fn new(sums: &Sums, samples: usize, rounding: f64) -> Self {
        // A jump that takes some samples reaches its height across a pause.
        let pause = samples / 2;
        let reach = samples + pause;
        let at = |index: usize| {
            let from = index.checked_sub(reach)?;
            let before = sums.mean(from..index - pause)?;
            let after = (index + reach <= sums.len()).then_some(index + pause..index + reach)?;
            Some(sums.mean(after)? - before)
        };
        let all: Vec<f64> = (0..sums.len()).map(|n| at(n).unwrap_or(f64::NAN)).collect();
        let there: Vec<f64> = all.iter().copied().filter(|one| one.is_finite()).collect();
        Self {
            spread: middle_spread(&there).max(rounding),
            all,
            reach,
        }
    }

    /// What stands out to one side without a break, each by its middle.
    pub fn jumps(&self) -> Vec<Seen> {
        let side = |value: &f64| match value.abs() > BEYOND * self.spread {
            true => value.signum() as i8,
            false => 0,
        };
        let mut begin = 0;
        let runs = self.all.chunk_by(|a, b| side(a) == side(b));
        let stand_out = runs.filter_map(|run| {
            let from = begin;
            begin += run.len();
            (side(&run[0]) != 0).then_some(from..begin)
        });
        stand_out.map(|range| self.largest(range)).collect()
    }

    /// The largest difference among some, at the middle of those that are nearly as large.
    fn largest(&self, range: Range<usize>) -> Seen {
        let sizes = &self.all[range.clone()];
        let height =
            sizes.iter().copied().fold(
                0.0,
                |most: f64, one| {
                    if one.abs() > most.abs() { one } else { most }
                },
            );
        let is_large = |one: &f64| one.abs() >= PLATEAU * height.abs();
        let first = sizes.iter().position(is_large).unwrap_or(0);
        let last = sizes.iter().rposition(is_large).unwrap_or(0);
        Seen {
            index: range.start + first.midpoint(last),
            height,
        }
    }

    /// The largest difference to the side of `sign` between two moments.
    pub fn largest_to(&self, sign: f64, between: Range<usize>) -> Option<Seen> {
        let sized = between.map(|index| Seen {
            index,
            height: self.all[index],
        });
        sized
            .filter(|one| one.height * sign > 0.0)
            .max_by(|a, b| a.height.abs().total_cmp(&b.height.abs()))
    }
}
