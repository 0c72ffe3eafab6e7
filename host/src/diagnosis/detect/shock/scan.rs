//! Where in a record something stands out, from short windows to long ones.
//!
//! What stands out in short windows is kept out of the longer ones, as if it were missing: so an event has the
//! length that it shows at, and a knock of a thousand deviations does not fill a window of a minute.

#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::OnceLock;

use statrs::distribution::{ContinuousCDF, Normal};

use super::across::across;
use super::stretch::{Stretch, joined, lasting};
use super::usual::{Height, Usual};
use super::windows::{OVERLAP, Windows};
use crate::diagnosis::record::runs::{middle, runs_of, without};
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::statistic::tails::normal_of_log;
use crate::numeric::order::{median, quantile};

/// Samples of the shortest window, and the factor between lengths: choices. An event between two lengths keeps
/// some nine tenths of its height.
const SHORTEST: usize = 16;
const FACTOR: usize = 4;

/// The longest window: seconds, but at least as many samples, and at most as large a part of the record:
/// choices. What rings for longer is a line, what bulges for longer is drift.
const LONGEST_S: f64 = 8.0;
const LONGEST_LEAST: usize = 256;
const LONGEST_PART: usize = 24;

/// Share of the samples that must stand in runs of a few of the shortest windows; else gaps are everywhere, and
/// are looked across.
const IN_RUNS: f64 = 0.5;

/// Height below which a window shows nothing: a choice, beyond which one of some 10 000 windows stands. What stands out lasts
/// until there is nothing, not only while chance does not explain it.
pub const NOTHING: f64 = 4.0;

/// A record that is looked through.
pub struct Scan<'a> {
    values: &'a [f64],
    /// The same, NaN where samples are missing.
    seen: &'a [f64],
    /// Runs of samples that are there.
    runs: Vec<Range<usize>>,
    /// The samples with the mean of its neighbours for each single one that is missing: no louder than what was there.
    whole: Vec<f64>,
    /// Runs of those.
    whole_runs: Vec<Range<usize>>,
    unit: f64,
    /// Power of one sample that rounding makes at least, in squared units.
    least: f64,
    usual: Vec<Usual>,
    /// Height from which a window stands out.
    threshold: f64,
    /// Windows' tests, all together.
    trials: f64,
    /// How many of all samples lie far off those beside them, once that was asked.
    far_off: OnceLock<usize>,
}

impl<'a> Scan<'a> {
    /// Of a record with gaps that are `bridged`; NaN in `values` where samples are missing. `None` where it is
    /// too short, or does not change.
    pub fn new(values: &'a [f64], bridged: &'a [f64]) -> Option<Self> {
        let runs = runs_of(values.len(), |n| values[n].is_finite());
        let long = runs
            .iter()
            .map(Range::len)
            .filter(|len| *len >= 4 * SHORTEST);
        let there: usize = runs.iter().map(Range::len).sum();
        let seen = values;
        let (values, runs) = if (long.sum::<usize>() as f64) < IN_RUNS * there as f64 {
            (bridged, std::iter::once(0..values.len()).collect())
        } else {
            (values, runs)
        };
        let (unit, least) = unit(values)?;
        let whole = over_single_gaps(values);
        Some(Self {
            values,
            seen,
            runs,
            whole_runs: runs_of(whole.len(), |n| whole[n].is_finite()),
            whole,
            unit,
            least,
            usual: Vec::new(),
            threshold: f64::INFINITY,
            trials: 0.0,
            far_off: OnceLock::new(),
        })
    }

    /// How many of all samples lie far off those beside them, as `count` has it; made once.
    pub fn far_off(&self, count: impl FnOnce(&Self) -> usize) -> usize {
        *self.far_off.get_or_init(|| count(self))
    }

    /// The samples.
    pub const fn values(&self) -> &'a [f64] {
        self.values
    }

    /// The samples that were measured; NaN where they are missing.
    pub const fn seen(&self) -> &'a [f64] {
        self.seen
    }

    /// Runs of samples that are there.
    pub fn runs(&self) -> &[Range<usize>] {
        &self.runs
    }

    /// Whether a sample was measured, not bridged.
    pub fn is_seen(&self, index: usize) -> bool {
        self.seen[index].is_finite()
    }

    /// Share of some samples that is missing.
    pub fn missing(&self, samples: &Range<usize>) -> f64 {
        let missing = self.seen[samples.clone()].iter();
        let missing = missing.filter(|value| !value.is_finite()).count();
        missing as f64 / samples.len() as f64
    }

    /// How far most of some samples that are there span: all but the `rest`, at either end.
    pub fn span(&self, samples: &Range<usize>, rest: f64) -> f64 {
        let there = self.seen[samples.clone()].iter().copied();
        let mut there: Vec<f64> = there.filter(|value| value.is_finite()).collect();
        let ends = [rest, 1.0 - rest].map(|share| quantile(&mut there, share).unwrap_or(0.0));
        ends[1] - ends[0]
    }

    /// The samples without single gaps: each is the mean of its neighbours, no louder than what was there.
    pub fn whole(&self) -> &[f64] {
        &self.whole
    }

    /// Runs of those.
    pub fn whole_runs(&self) -> &[Range<usize>] {
        &self.whole_runs
    }

    /// Variance of white noise that hardly counts beside that of the record.
    pub fn faint(&self) -> f64 {
        self.usual.first().map_or(0.0, Usual::faint)
    }

    /// Height from which a window stands out.
    pub const fn threshold(&self) -> f64 {
        self.threshold
    }

    /// Stretches that stand out at a `level`, ascending.
    pub fn stretches(&mut self, level: f64, rate_hz: f64) -> Vec<Stretch> {
        let longest = ((LONGEST_S * rate_hz) as usize).max(LONGEST_LEAST);
        let longest = longest.min(self.values.len() / LONGEST_PART);
        let lengths = std::iter::successors(Some(SHORTEST), |len| Some(len * FACTOR));
        let lengths: Vec<usize> = lengths.take_while(|len| *len <= longest).collect();
        // All windows of all lengths: one test a sample and length, and a few for the sums.
        self.trials = 2.5 * (lengths.len() * self.values.len()) as f64;
        self.threshold = normal_of_log((level / self.trials).ln());
        let mut found: Vec<Stretch> = Vec::new();
        for len in lengths {
            let Some((usual, windows)) = self.of_length(len, &found) else {
                continue;
            };
            found.extend(lasting(windows, self.threshold));
            found = joined(found, |_, _| 0);
            found
                .iter_mut()
                .for_each(|one| one.longest = one.samples.len());
            self.usual.push(usual);
        }
        found
    }

    /// What is usual in windows of `len` samples, and those of them in which something is, beside what was `found` in
    /// shorter ones and across it; `None` where they are too few.
    fn of_length(&self, len: usize, found: &[Stretch]) -> Option<(Usual, Vec<Stretch>)> {
        let holes: Vec<Range<usize>> = found.iter().map(|one| one.samples.clone()).collect();
        let left = without(&self.runs, &holes);
        let windows = Windows::new(len);
        let starts: Vec<usize> = left.iter().flat_map(|run| windows.starts(run)).collect();
        let mut usual = Usual::new(windows, self.values, self.unit, &starts, self.least)?;
        let shorter = self.usual.last().and_then(Usual::rare);
        let least = NOTHING.min(self.threshold);
        let beside = usual.heights(self.values, &starts, least, shorter);
        let across = across(&usual, self.values, &self.runs, found, self.threshold);
        let stretch = |(start, height): (usize, Height), runs: &[Range<usize>]| Stretch {
            samples: middle(start, len, runs),
            z: height.z,
            frequency: usual.frequency(height),
            window: len,
            longest: 0,
            nats: 0.5 * height.z.powi(2) / OVERLAP as f64,
        };
        let beside = beside.into_iter().map(|one| stretch(one, &left));
        let across = across.into_iter().map(|one| stretch(one, &self.runs));
        let both = beside.chain(across).collect();
        Some((usual, both))
    }

    /// Probability that anything in steady noise stands out as far.
    pub fn p_value(&self, z: f64) -> f64 {
        p_value::searched(Normal::standard().sf(z), self.trials).max(f64::MIN_POSITIVE)
    }

    /// The highest window of `longest` samples at most that lies in a `run` of some values of this record and comes
    /// within its own length of `about`.
    pub fn highest(
        &self,
        run: &Range<usize>,
        about: &Range<usize>,
        values: &[f64],
        longest: usize,
    ) -> f64 {
        let short = self
            .usual
            .iter()
            .filter(|usual| usual.windows.len() <= longest);
        let heights = short.map(|usual| {
            let windows = &usual.windows;
            let len = windows.len();
            let from = run.start.max(about.start.saturating_sub(len));
            let to = run.end.min(about.end + len);
            if to < from + len {
                return 0.0;
            }
            let mut memory = (windows.scratch(), Vec::new());
            let mut height = |start| -> Height { usual.height(values, start, 0.0, &mut memory) };
            let starts = windows.starts(&(from..to));
            starts.map(|start| height(start).z).fold(0.0, f64::max)
        });
        heights.fold(0.0, f64::max)
    }
}

/// Some samples with the mean of its neighbours for each single one that is missing; NaN where more are.
fn over_single_gaps(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    for n in 1..values.len().saturating_sub(1) {
        if !values[n].is_finite() {
            // No number again where either is missing too.
            values[n] = 0.5 * (values[n - 1] + values[n + 1]);
        }
    }
    values
}

/// What a record is measured in: the middle of its increments, or their root mean square where most are zero;
/// and the power of one sample that rounding to the least of them makes, in that unit squared.
fn unit(values: &[f64]) -> Option<(f64, f64)> {
    /// Increments that are looked at, at most: a choice.
    const INCREMENTS: usize = 1 << 18;
    let stride = values.len().div_ceil(INCREMENTS).max(1);
    let pairs = values.windows(2).step_by(stride);
    let steps = pairs.map(|pair| (pair[1] - pair[0]).abs());
    let mut steps: Vec<f64> = steps.filter(|step| step.is_finite()).collect();
    let largest = steps.iter().copied().fold(0.0, f64::max);
    let least = steps.iter().copied().filter(|step| *step > 0.0);
    let least = least.fold(f64::INFINITY, f64::min);
    if !least.is_finite() {
        return None;
    }
    let count = steps.len() as f64;
    let mut unit = median(&mut steps).unwrap_or(0.0);
    if unit == 0.0 {
        let squares: f64 = steps.iter().map(|step| (step / largest).powi(2)).sum();
        unit = largest * (squares / count).sqrt();
    }
    Some((unit, (least / unit).powi(2) / 12.0))
}
