//! Accumulates the chunks of a source, axis by axis.

mod account;
mod axis;
mod sum;

use super::unusable::Unusable;
use crate::clocks::Clocks;
use crate::source::{Chunk, Column};
use crate::spectrum::Plan;

pub use account::Account;
pub(super) use axis::Missing;
pub use axis::{AxisRecord, Overlap};

/// A record being accumulated.
#[derive(Clone)]
pub struct Record {
    account: Account,
    axes: Vec<AxisRecord>,
    /// Index that the next sample should have, where the count goes on.
    next: Option<u64>,
}

impl Record {
    /// An empty record of `axes` axes.
    pub fn new(axes: usize, overlap: Overlap) -> Self {
        let plan = Plan::new();
        Self {
            account: Account::default(),
            axes: (0..axes).map(|_| AxisRecord::new(overlap, &plan)).collect(),
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
    pub fn enter_clocks(&mut self, clocks: Option<Clocks>) {
        self.account.clocks = clocks;
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

#[cfg(test)]
mod tests {
    use inm_allan::Statistic;

    use super::*;
    use crate::source::{Block, Gap, Values};

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
