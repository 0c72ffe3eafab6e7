//! Whether a short stretch is one moment: a cut through the record, or a single sample.

use std::ops::Range;

use super::course;
use super::scan::{NOTHING, Scan};

/// Samples up to which a stretch may be one moment: two of the shortest windows, and what joins them.
pub const MOMENT: usize = 64;

/// Samples before and after a cut, at least: where there are none, that is no cut.
const BESIDE: usize = 8;

/// A stretch that may be one moment.
pub struct Moment<'a> {
    scan: &'a Scan<'a>,
    /// Values about it.
    values: &'a [f64],
    /// Its place among them.
    place: Range<usize>,
    /// The sample of the record that is the first of them.
    first: usize,
}

impl<'a> Moment<'a> {
    /// Of `samples` of a record, with those that are `near`.
    pub fn new(scan: &'a Scan<'a>, near: Range<usize>, samples: &Range<usize>) -> Self {
        Self {
            scan,
            place: samples.start - near.start..samples.end - near.start,
            first: near.start,
            values: &scan.values()[near],
        }
    }

    /// Whether nothing stands out about the place in a run of some values.
    fn is_nothing(&self, run: Range<usize>, values: &[f64]) -> bool {
        self.scan.highest(&run, &self.place, values, MOMENT) < NOTHING
    }

    /// Whether nothing is left where the record is cut at one moment of it.
    pub fn is_cut(&self) -> bool {
        let len = self.values.len();
        let first = self.place.start.max(BESIDE);
        let last = self.place.end.min(len.saturating_sub(BESIDE));
        (first..=last)
            .any(|n| self.is_nothing(0..n, self.values) && self.is_nothing(n..len, self.values))
    }

    /// Whether nothing is left without one sample of it, and what was bridged beside that.
    pub fn is_one_sample(&self) -> bool {
        let values = self.values;
        let Some(largest) = course::largest(values, &self.place) else {
            return false;
        };
        let is_seen = |n: &usize| self.scan.is_seen(self.first + n);
        let before = (0..largest).rev().find(is_seen);
        let after = (largest + 1..values.len()).find(is_seen);
        let Some(level) = before.or(after).map(|n| values[n]) else {
            return false;
        };
        let ends = [before, after].map(|n| n.map_or(level, |n| values[n]));
        let gone = before.map_or(0, |n| n + 1)..after.unwrap_or(values.len());
        let parts = (gone.len() + 1) as f64;
        let mut without = values.to_vec();
        for (part, value) in without[gone].iter_mut().enumerate() {
            let share = (part + 1) as f64 / parts;
            *value = ends[0] + share * (ends[1] - ends[0]);
        }
        self.is_nothing(0..without.len(), &without)
    }
}
