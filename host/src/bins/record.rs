//! Accumulates the chunks of a source, axis by axis.

use inm_allan::{BlockEstimate, Estimate, Statistic};

use super::bridge::Bridge;
use super::full::Segments;
use super::strided::Strided;
use super::unusable::Unusable;
use crate::source::{Chunk, Column, Gap, Values};
use crate::spectrum::{Cascade, Plan};

/// Which differences enter an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Overlap {
    /// At least 24 an averaging time, four averaging times an octave, in bounded memory.
    #[default]
    Strided,
    /// Every one, at any averaging time; keeps the record in memory.
    Full,
}

/// What a record consists of, for all axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Account {
    /// Samples that arrived, an axis.
    pub samples: u64,
    /// Samples known to be missing from all axes.
    pub lost: u64,
    /// Gaps in all axes.
    pub gaps: Vec<Gap>,
    /// Samples a second by the board's stamps; `None` where there are none, or too few.
    pub measured_rate_hz: Option<f64>,
    /// What does not count of one axis alone, axis by axis; empty before the first block.
    pub unusable: Vec<Unusable>,
    /// News on the way, in words.
    pub news: Vec<String>,
}

/// A record being accumulated.
#[derive(Clone)]
pub struct Record {
    account: Account,
    axes: Vec<AxisRecord>,
    /// Index that the next sample should have, where the count goes on.
    next: Option<u64>,
}

/// One axis of it.
#[derive(Clone)]
pub struct AxisRecord {
    bins: AxisBins,
    bridge: Bridge,
    cascade: Cascade,
    /// Samples and missing ones so far: the cascade's index.
    position: u64,
    count: u64,
    invalid: u64,
    sum: Sum,
}

/// What is missing from all axes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Missing {
    /// So many samples, perhaps none.
    Samples(u64),
    /// Nobody knows how many.
    Unknown,
}

#[derive(Clone)]
enum AxisBins {
    Strided(Strided),
    Full(Segments),
}

impl Record {
    /// An empty record of `axes` axes.
    pub fn new(axes: usize, overlap: Overlap) -> Self {
        let plan = Plan::new();
        let axis = || AxisRecord {
            bins: match overlap {
                Overlap::Strided => AxisBins::Strided(Strided::default()),
                Overlap::Full => AxisBins::Full(Segments::default()),
            },
            bridge: Bridge::default(),
            cascade: Cascade::new(&plan),
            position: 0,
            count: 0,
            invalid: 0,
            sum: Sum::default(),
        };
        Self {
            account: Account::default(),
            axes: (0..axes).map(|_| axis()).collect(),
            next: None,
        }
    }

    /// Takes the next chunk of a source.
    pub fn push(&mut self, chunk: Chunk) {
        let (missing, columns) = self.enter(chunk);
        for axis in &mut self.axes {
            axis.pass_over(missing);
        }
        for (axis, column) in self.axes.iter_mut().zip(&columns) {
            axis.push(column);
        }
    }

    /// Enters a chunk into the account: what is missing from all axes ahead of it, and the column
    /// of each axis, if it has any.
    pub(super) fn enter(&mut self, chunk: Chunk) -> (Missing, Vec<Column>) {
        match chunk {
            Chunk::Samples(block) => {
                // Indices jump where samples are missing, announced by a gap or not.
                let missing = match self.next {
                    Some(next) if block.first < next => Missing::Unknown,
                    Some(next) => Missing::Samples(block.first - next),
                    None => Missing::Samples(0),
                };
                self.next = Some(block.end());
                self.account.samples += block.len() as u64;
                Unusable::enter(&mut self.account.unusable, &block);
                (missing, block.columns)
            }
            Chunk::Gap(gap) => {
                self.account.lost += gap.to.map_or(0, |to| to.saturating_sub(gap.from));
                let missing = if gap.to.is_none() {
                    // A new count begins: what its first index is does not matter.
                    self.next = None;
                    Missing::Unknown
                } else {
                    Missing::Samples(0)
                };
                self.account.gaps.push(gap);
                (missing, Vec::new())
            }
            Chunk::News(news) => {
                self.account.news.push(news);
                (Missing::Samples(0), Vec::new())
            }
        }
    }

    /// Enters what the source says of its rate.
    pub fn enter_rate(&mut self, measured_rate_hz: Option<f64>) {
        self.account.measured_rate_hz = measured_rate_hz;
    }

    /// Samples, losses and gaps so far.
    pub fn account(&self) -> &Account {
        &self.account
    }

    /// The axes.
    pub fn axes(&self) -> &[AxisRecord] {
        &self.axes
    }

    /// The axes, to be filled elsewhere and put back.
    pub(super) fn axes_mut(&mut self) -> &mut Vec<AxisRecord> {
        &mut self.axes
    }
}

impl AxisRecord {
    /// A gap in all axes.
    pub(super) fn pass_over(&mut self, missing: Missing) {
        match missing {
            Missing::Samples(missing) => self.skip(missing),
            Missing::Unknown => {
                self.bins.skip(1);
                self.bridge.restart();
                self.position += 1;
            }
        }
    }

    /// The next samples.
    pub(super) fn push(&mut self, column: &Column) {
        let end = column.values.len();
        let mut from = 0;
        for bad in column
            .invalid
            .iter()
            .cloned()
            .chain(std::iter::once(end..end))
        {
            if bad.start > from {
                self.push_run(&column.values, from..bad.start);
            }
            self.skip(bad.len() as u64);
            self.invalid += bad.len() as u64;
            from = bad.end;
        }
    }

    fn skip(&mut self, missing: u64) {
        if missing > 0 {
            self.bins.skip(missing);
            self.bridge.skip(missing);
            self.position += missing;
        }
    }

    fn push_run(&mut self, values: &Values, run: std::ops::Range<usize>) {
        let first = self.position;
        self.position += run.len() as u64;
        self.count += run.len() as u64;
        let in_order = match values {
            Values::Codes(codes) => {
                let run = &codes[run];
                self.sum.add_codes(run);
                self.bridge.push_codes(run);
                match &mut self.bins {
                    AxisBins::Strided(bins) => bins.push_codes(run),
                    AxisBins::Full(segments) => segments.push_codes(run),
                }
                self.cascade.push_codes(first, run)
            }
            Values::Floats(floats) => {
                let run = &floats[run];
                self.sum.add_floats(run);
                self.bridge.push_floats(run);
                match &mut self.bins {
                    AxisBins::Strided(bins) => bins.push_floats(run),
                    AxisBins::Full(segments) => segments.push_floats(run),
                }
                self.cascade.push_values(first, run)
            }
        };
        // The position only grows.
        debug_assert!(in_order.is_ok());
    }

    /// The spectrum so far, in squared counts.
    pub fn cascade(&self) -> &Cascade {
        &self.cascade
    }

    /// Samples that count.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Samples of this axis alone that were marked as unusable.
    pub fn invalid(&self) -> u64 {
        self.invalid
    }

    /// Mean in counts, `None` without samples.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum.value() / self.count as f64)
    }

    /// Estimates in squared counts, ascending in `m`: at the averaging factors `factors` with
    /// full overlap; at those of them that the bins hold where it is strided.
    pub fn estimates(&self, statistic: Statistic, factors: &[u64]) -> Vec<Estimate> {
        match &self.bins {
            AxisBins::Full(segments) => segments.estimates(statistic, factors),
            AxisBins::Strided(bins) => {
                let mut all = bins.estimates(statistic);
                all.retain(|estimate| factors.binary_search(&estimate.m).is_ok());
                all
            }
        }
    }

    /// Allan variance in squared counts from the means of incomplete blocks, ascending in `m`:
    /// where gaps leave no whole difference, up to `longest`.
    pub fn bridged(&self, longest: u64) -> Vec<BlockEstimate> {
        let mut estimates = self.bridge.estimates();
        let whole = match &self.bins {
            AxisBins::Full(segments) => segments.longest() / 2,
            AxisBins::Strided(bins) => bins
                .estimates(Statistic::Allan)
                .last()
                .map_or(0, |estimate| estimate.m),
        };
        estimates
            .retain(|BlockEstimate { estimate, .. }| (whole + 1..=longest).contains(&estimate.m));
        estimates
    }

    /// Estimates in squared counts at the averaging factors `factors`, or at the nearest ones
    /// that the bins hold, each once.
    pub fn nearest(&self, statistic: Statistic, factors: &[u64]) -> Vec<Estimate> {
        let AxisBins::Strided(bins) = &self.bins else {
            return self.estimates(statistic, factors);
        };
        let all = bins.estimates(statistic);
        let distance = |estimate: &Estimate, m: u64| (estimate.m as f64 / m as f64).ln().abs();
        let mut near: Vec<Estimate> = factors
            .iter()
            .filter_map(|&m| {
                all.iter()
                    .min_by(|a, b| distance(a, m).total_cmp(&distance(b, m)))
                    .copied()
            })
            .collect();
        near.dedup_by_key(|estimate| estimate.m);
        near
    }
}

impl AxisBins {
    /// A gap.
    fn skip(&mut self, missing: u64) {
        match self {
            Self::Strided(bins) => bins.skip(missing),
            Self::Full(segments) => segments.end(),
        }
    }
}

/// A sum that does not lose the small against the large.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    codes: i128,
    floats: f64,
    /// What was rounded off `floats` (Neumaier 1974).
    rest: f64,
}

impl Sum {
    fn add_codes(&mut self, codes: &[i32]) {
        // A run in memory is shorter than 2^32, so 64 bits hold its sum.
        self.codes += i128::from(codes.iter().map(|&code| i64::from(code)).sum::<i64>());
    }

    fn add_floats(&mut self, floats: &[f64]) {
        // Short plain sums round at the size of their own few samples only.
        for few in floats.chunks(64) {
            let value: f64 = few.iter().sum();
            let total = self.floats + value;
            self.rest += if self.floats.abs() >= value.abs() {
                (self.floats - total) + value
            } else {
                (value - total) + self.floats
            };
            self.floats = total;
        }
    }

    fn value(&self) -> f64 {
        self.codes as f64 + (self.floats + self.rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Block;

    fn floats(first: u64, values: &[f64], invalid: Vec<std::ops::Range<usize>>) -> Chunk {
        let column = Column {
            values: Values::Floats(values.to_vec()),
            invalid,
        };
        Chunk::Samples(Block {
            first,
            columns: vec![column],
        })
    }

    #[test]
    fn both_overlaps_count_the_same_short_differences_across_gaps() {
        for overlap in [Overlap::Strided, Overlap::Full] {
            let mut record = Record::new(1, overlap);
            let samples = [9.8, 9.9, 9.7, f64::NAN, 9.8, 9.6, 9.9, 9.7];
            record.push(floats(0, &samples, std::iter::once(3..4).collect()));
            record.push(Chunk::Gap(Gap {
                from: 8,
                to: Some(10),
                cause: "test".into(),
            }));
            record.push(floats(10, &[9.8, 9.9], vec![]));
            record.push(Chunk::Gap(Gap {
                from: 12,
                to: None,
                cause: "test".into(),
            }));
            record.push(floats(0, &[9.5, 9.9], vec![]));
            let axis = &record.axes()[0];
            assert_eq!(
                (axis.count(), axis.invalid(), record.account().lost),
                (11, 1, 2)
            );
            let mean = axis.mean().expect("samples");
            assert!(
                (mean - (9.8 + 9.9 + 9.7 + 9.8 + 9.6 + 9.9 + 9.7 + 19.7 + 19.4) / 11.0).abs()
                    < 1e-12
            );
            let one = axis.estimates(Statistic::Allan, &[1])[0];
            let steps: [f64; 7] = [0.1, -0.2, -0.2, 0.3, -0.2, 0.1, 0.4];
            let expected = steps.iter().map(|step| step * step).sum::<f64>() / 14.0;
            assert_eq!(one.terms, 7, "{overlap:?}");
            // The grid of the first run, 9.7 to 9.9 with headroom, has steps of 2^-28: rounding
            // to it moves a deviation by less than one of them.
            let tolerance = 2.0 * 2.0_f64.powi(-28) / expected.sqrt();
            assert!(
                (one.variance / expected - 1.0).abs() < tolerance,
                "{overlap:?} {}",
                one.variance
            );
        }
    }

    #[test]
    fn nearest_of_the_bins() {
        let mut record = Record::new(1, Overlap::Strided);
        let samples: Vec<f64> = (0..200).map(|k| f64::from(k % 7)).collect();
        record.push(floats(0, &samples, vec![]));
        let factors: Vec<u64> = record.axes()[0]
            .nearest(Statistic::Allan, &[1, 9, 11, 70])
            .iter()
            .map(|estimate| estimate.m)
            .collect();
        assert_eq!(factors, [1, 10, 12, 64]);
    }
}
