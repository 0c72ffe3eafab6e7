//! The host's estimator: Allan, modified Allan and Hadamard variance from one pass.

use crate::block::Scratch;
use crate::engine::{Engine, LAST_INDEX};
use crate::grid::BLOCK;
use crate::head::Head;
use crate::knot::Running;
use crate::sums::FamilySums;
use crate::{Estimate, Statistic};

/// [`Bins`] for records of any practical length: averaging times to 40 * 2^33 samples, beyond a
/// quarter of a record of 2^40, in at most 128 KiB.
pub type HostBins = Bins<33>;

/// Streaming Allan, modified Allan and Hadamard variance at four averaging times an octave, from 1
/// to `40 * 2^LEVELS` samples.
///
/// The modified variance takes its full inner sum; only the outer one is strided. Its differences
/// end where a Hadamard difference does, one sample later than they need, so at stride 1 they are
/// one fewer than in [`full`](crate::full). `LEVELS` is at most 33, checked at compile time.
///
/// ```
/// use inm_allan::{Bins, Statistic};
/// let mut bins = Bins::<4>::new();
/// bins.push_slice(&[3, 1, 4, 1, 5, 9, 2, 6]);
/// bins.skip(10); // ten samples were lost
/// bins.push_slice(&[5, 3, 5]);
/// let terms: Vec<_> = bins.points(Statistic::Allan).map(|point| point.terms).collect();
/// assert_eq!(terms, [7 + 2, 5, 3, 1]);
/// ```
#[derive(Debug, Clone)]
pub struct Bins<const LEVELS: usize> {
    pub(crate) engine: Engine<FamilySums, LEVELS>,
    pub(crate) head: Head<LEVELS>,
}

impl<const LEVELS: usize> Bins<LEVELS> {
    /// Empty, the first sample having index 0.
    #[must_use]
    pub const fn new() -> Self {
        Self::starting_at(0)
    }

    /// Empty, the first sample having absolute index `first`.
    #[must_use]
    pub const fn starting_at(first: u64) -> Self {
        const {
            assert!(LEVELS <= 33, "an inner sum must fit 111 bits");
        };
        Self {
            engine: Engine::new(first),
            head: Head::new(first),
        }
    }

    /// Accepts one code.
    #[inline]
    pub fn push(&mut self, code: i32) {
        self.push_wide(i64::from(code));
    }

    /// Accepts one code below the bound that the type's levels allow.
    #[inline]
    pub(crate) fn push_wide(&mut self, code: i64) {
        let taken_over = self.engine.push(code);
        self.head
            .file_ground(self.engine.next, self.engine.running.knot());
        if let Some((level, index, knot)) = taken_over {
            self.head.file(level, index, knot);
        }
    }

    /// Accepts at most [`BLOCK`] codes that differ by at most `spread`.
    pub(crate) fn push_block(
        &mut self,
        scratch: &mut Scratch,
        codes: impl ExactSizeIterator<Item = i64> + Clone,
        spread: u64,
    ) {
        let (head, begin) = (&mut self.head, self.engine.next);
        self.engine.push_block(scratch, codes, spread, |end, knot| {
            if head.end.is_none() {
                head.extend(begin, end, false, knot);
            }
        });
    }

    /// Accepts a run of codes; the result is the same bits as pushing them one by one.
    ///
    /// Fastest for slices of thousands. Needs about 110 KiB of stack.
    pub fn push_slice(&mut self, codes: &[i32]) {
        let mut scratch = Scratch::EMPTY;
        for block in codes.chunks(BLOCK) {
            let codes = block.iter().map(|&code| i64::from(code));
            self.push_block(&mut scratch, codes, u64::from(u32::MAX));
        }
    }

    /// Passes over `missing` samples that were lost or flagged: a gap. Zero is no gap.
    pub fn skip(&mut self, missing: u64) {
        // At the last index there is nothing left to pass over, and a run that ends must be
        // followed by a gap.
        let missing = missing.min(LAST_INDEX.saturating_sub(self.engine.next));
        if missing > 0 {
            self.head.close(self.engine.next, &self.engine.history);
            self.engine.skip(missing);
        }
    }

    /// Absolute index of the first sample that these bins speak for.
    #[must_use]
    pub fn first_index(&self) -> u64 {
        self.engine.first
    }

    /// Absolute index of the next sample.
    #[must_use]
    pub fn next_index(&self) -> u64 {
        self.engine.next
    }

    /// Samples accepted, without the missing ones.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.engine.samples
    }

    /// One statistic at every averaging time that has a difference, shortest first.
    pub fn points(&self, statistic: Statistic) -> impl Iterator<Item = Estimate> + '_ {
        self.engine.points(statistic)
    }
}

/// Equal when they were fed the same samples with the same gaps, in whatever pieces.
impl<const LEVELS: usize> PartialEq for Bins<LEVELS> {
    fn eq(&self, other: &Self) -> bool {
        self.engine == other.engine && self.head == other.head
    }
}

impl<const LEVELS: usize> Default for Bins<LEVELS> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_bins_fit_their_budget() {
        assert!(
            size_of::<HostBins>() <= 128 * 1024,
            "{}",
            size_of::<HostBins>()
        );
    }
}
