//! One axis of a record: its bins, its spectrum, and what was marked as unusable.

use inm_allan::{BlockEstimate, Estimate, Statistic};

use super::sum::Sum;
use crate::bins::bridge::Bridge;
use crate::bins::full::Segments;
use crate::bins::strided::Strided;
use crate::source::{Column, Values};
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
pub(in crate::bins) enum Missing {
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

impl AxisRecord {
    /// One without samples.
    pub(super) fn new(overlap: Overlap, plan: &Plan) -> Self {
        Self {
            bins: match overlap {
                Overlap::Strided => AxisBins::Strided(Strided::default()),
                Overlap::Full => AxisBins::Full(Segments::default()),
            },
            bridge: Bridge::default(),
            cascade: Cascade::new(plan),
            position: 0,
            count: 0,
            invalid: 0,
            sum: Sum::default(),
        }
    }

    /// A gap in all axes.
    pub(in crate::bins) fn pass_over(&mut self, missing: Missing) {
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
    pub(in crate::bins) fn push(&mut self, column: &Column) {
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
