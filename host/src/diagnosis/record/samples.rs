//! A whole record in memory: what the diagnosis goes through again and again.
//!
//! Codes stay codes, 4 bytes each; floating-point files take 8. Missing samples keep their
//! place, so that an index is a time.

use std::ops::Range;

use crate::bins::record::Account;
use crate::bins::unusable::Unusable;
use crate::diagnosis::record::spill::Spilled;
use crate::signal::Signal;
use crate::source::{Block, Chunk, Source, SourceError, Values};

/// All samples of a record.
#[derive(Debug, Clone)]
pub struct Samples {
    /// What they are samples of.
    pub signal: Signal,
    /// One for each axis of the signal.
    pub axes: Vec<AxisSamples>,
    /// Places where the count of missing samples is not known; one stands for them.
    pub unknown_gaps: Vec<usize>,
}

/// Samples of one axis, as they came.
#[derive(Debug, Clone)]
pub struct AxisSamples {
    values: Values,
    missing: Vec<Range<usize>>,
}

/// What a sample is to the one measured before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seen {
    /// Not measured.
    Missing,
    /// The same on all axes.
    Same,
    /// Another on some axis, or the first.
    New,
}

/// Samples of one axis whose turn has not come.
pub struct Waiting {
    values: Waits,
    missing: Vec<Range<usize>>,
}

enum Waits {
    Codes(Spilled<i32>),
    Floats(Spilled<f64>),
}

impl Waiting {
    /// The samples, out of memory if `in_file`.
    pub fn new(samples: AxisSamples, in_file: bool) -> Self {
        Self {
            values: match samples.values {
                Values::Codes(codes) => Waits::Codes(Spilled::new(codes, in_file)),
                Values::Floats(floats) => Waits::Floats(Spilled::new(floats, in_file)),
            },
            missing: samples.missing,
        }
    }

    /// The samples as they were, read back where they were written.
    ///
    /// # Errors
    /// If they cannot be read any more.
    pub fn back(self) -> std::io::Result<AxisSamples> {
        Ok(AxisSamples {
            values: match self.values {
                Waits::Codes(codes) => Values::Codes(codes.back()?),
                Waits::Floats(floats) => Values::Floats(floats.back()?),
            },
            missing: self.missing,
        })
    }
}

impl Samples {
    /// Reads `source` to its end; also returns what was lost on the way. `progress` is called with the
    /// samples so far.
    ///
    /// # Errors
    /// Whatever ends the source early.
    pub fn read(
        source: &mut dyn Source,
        mut progress: impl FnMut(u64),
    ) -> Result<(Self, Account), SourceError> {
        let signal = source.signal().clone();
        let mut samples = Self {
            axes: Vec::new(),
            unknown_gaps: Vec::new(),
            signal,
        };
        let mut account = Account::default();
        // Index that the source gives the sample at place 0, after the last restart.
        let mut origin: Option<i128> = None;
        while let Some(chunk) = source.next_chunk()? {
            match chunk {
                Chunk::Samples(block) => {
                    let length = samples.len();
                    let start = *origin.get_or_insert(i128::from(block.first) - length as i128);
                    let place = (i128::from(block.first) - start).max(length as i128);
                    samples.skip((place - length as i128) as usize);
                    samples.push(&block);
                    account.samples += block.len() as u64;
                    Unusable::enter(&mut account.unusable, &block);
                    progress(samples.len() as u64);
                }
                Chunk::Gap(gap) => {
                    account.lost += gap.to.map_or(0, |to| to.saturating_sub(gap.from));
                    if gap.to.is_none() {
                        samples.unknown_gaps.push(samples.len());
                        samples.skip(1);
                        origin = None;
                    }
                    account.gaps.push(gap);
                }
                Chunk::News(news) => account.news.push(news),
            }
        }
        Ok((samples, account))
    }

    /// Samples an axis, missing ones included.
    pub fn len(&self) -> usize {
        self.axes.first().map_or(0, |axis| axis.values.len())
    }

    /// What each sample is to the one measured before it; one that any axis lacks is missing.
    pub fn seen(&self) -> impl Iterator<Item = Seen> {
        let mut is_missing = vec![false; self.len()];
        for gap in self.axes.iter().flat_map(|axis| &axis.missing) {
            is_missing[gap.clone()].fill(true);
        }
        let mut last: Option<usize> = None;
        (0..self.len()).map(move |n| {
            let has_value = |axis: &AxisSamples| axis.values.is_finite(n);
            if is_missing[n] || !self.axes.iter().all(has_value) {
                return Seen::Missing;
            }
            let is_same = |before| self.axes.iter().all(|one| one.values.are_same(before, n));
            let seen = if last.is_some_and(is_same) {
                Seen::Same
            } else {
                Seen::New
            };
            last = Some(n);
            seen
        })
    }

    /// These samples alone, one after the other; `None` for one that is missing.
    pub fn picked(&self, samples: &[Option<usize>]) -> Self {
        let axis = |axis: &AxisSamples| {
            let of = |place: &Option<usize>| place.unwrap_or(0);
            let values = match &axis.values {
                Values::Codes(codes) => {
                    Values::Codes(samples.iter().map(|one| codes[of(one)]).collect())
                }
                Values::Floats(floats) => {
                    Values::Floats(samples.iter().map(|one| floats[of(one)]).collect())
                }
            };
            let mut picked = AxisSamples {
                values,
                missing: Vec::new(),
            };
            for (place, _) in samples.iter().enumerate().filter(|(_, one)| one.is_none()) {
                picked.mark(place..place + 1);
            }
            picked
        };
        Self {
            signal: self.signal.clone(),
            axes: self.axes.iter().map(axis).collect(),
            unknown_gaps: Vec::new(),
        }
    }

    fn skip(&mut self, missing: usize) {
        if missing == 0 {
            return;
        }
        for axis in &mut self.axes {
            let length = axis.values.len();
            axis.mark(length..length + missing);
            match &mut axis.values {
                Values::Codes(codes) => codes.resize(length + missing, 0),
                Values::Floats(floats) => floats.resize(length + missing, f64::NAN),
            }
        }
    }

    fn push(&mut self, block: &Block) {
        if self.axes.is_empty() {
            let axis = |column: &crate::source::Column| AxisSamples {
                values: match &column.values {
                    Values::Codes(_) => Values::Codes(Vec::new()),
                    Values::Floats(_) => Values::Floats(Vec::new()),
                },
                missing: Vec::new(),
            };
            self.axes = block.columns.iter().map(axis).collect();
        }
        for (axis, column) in self.axes.iter_mut().zip(&block.columns) {
            let length = axis.values.len();
            for bad in &column.invalid {
                axis.mark(length + bad.start..length + bad.end);
            }
            match (&mut axis.values, &column.values) {
                (Values::Codes(all), Values::Codes(new)) => all.extend(new),
                (Values::Floats(all), Values::Floats(new)) => all.extend(new),
                (Values::Floats(all), Values::Codes(new)) => {
                    all.extend(new.iter().map(|&code| f64::from(code)));
                }
                (all @ Values::Codes(_), Values::Floats(new)) => {
                    let codes = std::mem::replace(all, Values::Floats(Vec::new()));
                    let mut floats = codes.into_floats();
                    floats.extend(new);
                    *all = Values::Floats(floats);
                }
            }
        }
    }
}

impl Values {
    fn is_finite(&self, n: usize) -> bool {
        match self {
            Self::Codes(_) => true,
            Self::Floats(floats) => floats[n].is_finite(),
        }
    }

    fn are_same(&self, one: usize, other: usize) -> bool {
        match self {
            Self::Codes(codes) => codes[one] == codes[other],
            Self::Floats(floats) => floats[one].to_bits() == floats[other].to_bits(),
        }
    }

    fn into_floats(self) -> Vec<f64> {
        match self {
            Self::Codes(codes) => codes.into_iter().map(f64::from).collect(),
            Self::Floats(floats) => floats,
        }
    }
}

#[cfg(test)]
impl From<Vec<f64>> for AxisSamples {
    fn from(values: Vec<f64>) -> Self {
        Self {
            values: Values::Floats(values),
            missing: Vec::new(),
        }
    }
}

impl AxisSamples {
    fn mark(&mut self, bad: Range<usize>) {
        match self.missing.last_mut() {
            Some(last) if last.end == bad.start => last.end = bad.end,
            _ => self.missing.push(bad),
        }
    }

    /// As they came, in counts or in the unit of the file.
    pub fn raw(&self) -> &Values {
        &self.values
    }

    /// Values times `scale`, about their mean; missing ones are NaN. Also the mean that was taken
    /// out, times `scale`. Floating-point values keep their place in memory.
    pub fn centred(self, scale: f64) -> (Vec<f64>, f64) {
        let mut values = self.values.into_floats();
        for gap in &self.missing {
            values[gap.clone()].fill(f64::NAN);
        }
        let (mut sum, mut count) = (0.0, 0_u64);
        let reference = values.iter().copied().find(|value| value.is_finite());
        let reference = reference.unwrap_or(0.0);
        for value in values.iter().filter(|value| value.is_finite()) {
            sum += value - reference;
            count += 1;
        }
        let mean = reference + sum / count.max(1) as f64;
        for value in &mut values {
            *value = (*value - mean) * scale;
        }
        (values, mean * scale)
    }
}
