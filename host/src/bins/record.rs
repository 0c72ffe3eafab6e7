//! Accumulates the chunks of a source, axis by axis.

use inm_allan::{Estimate, Statistic, full};

use crate::source::{Block, Chunk, Column, Gap, Values};

/// What a record consists of, for all axes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Account {
    /// Samples that arrived, an axis.
    pub samples: u64,
    /// Samples known to be missing from all axes.
    pub lost: u64,
    /// Gaps in all axes.
    pub gaps: Vec<Gap>,
    /// News on the way, in words.
    pub news: Vec<String>,
}

/// A record being accumulated.
pub struct Record {
    account: Account,
    axes: Vec<AxisRecord>,
}

/// One axis of it.
pub struct AxisRecord {
    segments: Segments,
    /// Whether the next sample begins a new segment.
    broken: bool,
    count: u64,
    invalid: u64,
    /// Sum of the samples, with the part that was rounded off.
    sum: (f64, f64),
}

/// Samples between gaps, in counts.
enum Segments {
    Codes(Vec<Vec<i32>>),
    Floats(Vec<Vec<f64>>),
}

impl Record {
    /// An empty record of `axes` axes.
    pub fn new(axes: usize) -> Self {
        let axis = || AxisRecord {
            segments: Segments::Codes(Vec::new()),
            broken: true,
            count: 0,
            invalid: 0,
            sum: (0.0, 0.0),
        };
        Self {
            account: Account::default(),
            axes: (0..axes).map(|_| axis()).collect(),
        }
    }

    /// Takes the next chunk of a source.
    pub fn push(&mut self, chunk: Chunk) {
        match chunk {
            Chunk::Samples(block) => self.push_block(&block),
            Chunk::Gap(gap) => {
                self.account.lost += gap.to.map_or(0, |to| to.saturating_sub(gap.from));
                self.account.gaps.push(gap);
                self.axes.iter_mut().for_each(|axis| axis.broken = true);
            }
            Chunk::News(news) => self.account.news.push(news),
        }
    }

    fn push_block(&mut self, block: &Block) {
        self.account.samples += block.len() as u64;
        for (axis, column) in self.axes.iter_mut().zip(&block.columns) {
            axis.push(column);
        }
    }

    /// Samples, losses and gaps so far.
    pub fn account(&self) -> &Account {
        &self.account
    }

    /// The axes.
    pub fn axes(&self) -> &[AxisRecord] {
        &self.axes
    }
}

impl AxisRecord {
    fn push(&mut self, column: &Column) {
        let mut from = 0;
        let end = column.values.len();
        let bad = column
            .invalid
            .iter()
            .cloned()
            .chain(std::iter::once(end..end));
        for bad in bad {
            if bad.start > from {
                self.push_run(&column.values, from..bad.start);
            }
            if !bad.is_empty() {
                self.broken = true;
                self.invalid += bad.len() as u64;
            }
            from = bad.end;
        }
    }

    fn push_run(&mut self, values: &Values, run: std::ops::Range<usize>) {
        self.count += run.len() as u64;
        let broken = std::mem::replace(&mut self.broken, false);
        match values {
            Values::Codes(codes) => {
                codes[run.clone()]
                    .iter()
                    .for_each(|&code| self.add(f64::from(code)));
                match &mut self.segments {
                    Segments::Codes(segments) => extend(segments, &codes[run], broken),
                    Segments::Floats(segments) => {
                        let run: Vec<f64> = codes[run].iter().copied().map(f64::from).collect();
                        extend(segments, &run, broken);
                    }
                }
            }
            Values::Floats(floats) => {
                floats[run.clone()]
                    .iter()
                    .for_each(|&value| self.add(value));
                if let Segments::Codes(segments) = &self.segments {
                    let wider = |codes: &Vec<i32>| codes.iter().copied().map(f64::from).collect();
                    self.segments = Segments::Floats(segments.iter().map(wider).collect());
                }
                if let Segments::Floats(segments) = &mut self.segments {
                    extend(segments, &floats[run], broken);
                }
            }
        }
    }

    /// Adds to the sum without losing the low digits (Neumaier 1974).
    fn add(&mut self, value: f64) {
        let (sum, rest) = self.sum;
        let total = sum + value;
        let lost = if sum.abs() >= value.abs() {
            (sum - total) + value
        } else {
            (value - total) + sum
        };
        self.sum = (total, rest + lost);
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
        (self.count > 0).then(|| (self.sum.0 + self.sum.1) / self.count as f64)
    }

    /// The estimates at the averaging factors `factors` that the record is long enough for.
    pub fn estimates(&self, statistic: Statistic, factors: &[u64]) -> Vec<Estimate> {
        match &self.segments {
            Segments::Codes(segments) => {
                let segments: Vec<&[i32]> = segments.iter().map(Vec::as_slice).collect();
                let one = |&m: &u64| full::integers(statistic, &segments, m);
                factors.iter().filter_map(one).collect()
            }
            Segments::Floats(segments) => {
                let segments: Vec<&[f64]> = segments.iter().map(Vec::as_slice).collect();
                let one = |&m: &u64| full::floats(statistic, &segments, m);
                factors.iter().filter_map(one).collect()
            }
        }
    }
}

fn extend<T: Copy>(segments: &mut Vec<Vec<T>>, run: &[T], broken: bool) {
    match segments.last_mut() {
        Some(segment) if !broken => segment.extend_from_slice(run),
        _ => segments.push(run.to_vec()),
    }
}
