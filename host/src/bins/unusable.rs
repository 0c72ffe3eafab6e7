//! Samples of one axis alone that do not count: not a number, infinite, clipped, torn.

use std::ops::Range;

use crate::source::Block;

/// What does not count of one axis while the others have samples.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Unusable {
    /// Samples.
    pub samples: u64,
    /// Stretches that they lie in, each without a gap.
    pub stretches: u64,
    /// Index of the first.
    pub first: u64,
    /// Samples of the longest stretch.
    pub longest: u64,
    /// The last stretch, which may go on.
    last: Range<u64>,
}

impl Unusable {
    /// Enters what is marked in a block, axis by axis; `axes` has one for each once there was a block.
    pub fn enter(axes: &mut Vec<Self>, block: &Block) {
        axes.resize(block.columns.len(), Self::default());
        for (axis, column) in axes.iter_mut().zip(&block.columns) {
            for bad in &column.invalid {
                axis.mark(block.first + bad.start as u64..block.first + bad.end as u64);
            }
        }
    }

    fn mark(&mut self, bad: Range<u64>) {
        if self.samples == 0 {
            self.first = bad.start;
        }
        self.samples += bad.end - bad.start;
        if self.stretches > 0 && self.last.end == bad.start {
            self.last.end = bad.end;
        } else {
            self.stretches += 1;
            self.last = bad;
        }
        self.longest = self.longest.max(self.last.end - self.last.start);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{Column, Values};

    #[test]
    fn a_stretch_goes_on_over_the_ends_of_blocks() {
        let mut axes = Vec::new();
        for (first, invalid) in [(0, vec![2..3, 8..10]), (10, vec![0..4]), (20, vec![0..1])] {
            let column = Column {
                values: Values::Codes(vec![0; 10]),
                invalid,
            };
            let columns = vec![column];
            Unusable::enter(&mut axes, &Block { first, columns });
        }
        let expected = Unusable {
            samples: 8,
            stretches: 3,
            first: 2,
            longest: 6,
            last: 20..21,
        };
        assert_eq!(axes, [expected]);
    }
}
