//! The bins that both ends of the link keep, and by which the host proves that nothing was lost.
//!
//! ```text
//!   conversion --> ProofBins of the board --> BinsMark in the health record --+
//!        |                                                                    +--> equal?
//!        +--> batch, frame, line, decoder --> ProofBins of the host ----------+
//! ```
//!
//! What enters, and where, stands here once, so that the two ends cannot disagree about it. The
//! board takes conversions one at a time and the host runs of them, which is quicker there; the
//! bins come out the same. The proof reaches from the word that was judged on the board to the
//! word that the host works with.

use core::ops::Range;

use inm_allan::BoardBins;
use inm_protocol::{AXES, Batch, BinsMark, Code, Flags};

/// Bins of X, Y and Z, begun at one conversion: 47 KiB.
///
/// A word without flags enters its axis at its index. Everything else is simply not there, and
/// the next good word finds how far the index has moved: a flagged word is a gap of its axis,
/// missing conversions are one of all three.
#[derive(Debug, Clone)]
pub struct ProofBins {
    epoch: u64,
    axes: [BoardBins; AXES],
}

impl ProofBins {
    /// Empty, to begin with conversion 0.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            epoch: 0,
            axes: [const { BoardBins::new() }; AXES],
        }
    }

    /// Begins anew with conversion `epoch`; those before it are passed over.
    pub fn begin(&mut self, epoch: u64) {
        self.epoch = epoch;
        for bins in &mut self.axes {
            // Stops at 2^63 conversions, which only a damaged number can name.
            bins.restart(epoch);
        }
    }

    /// Conversion with which the bins begin.
    #[must_use]
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Takes one conversion. Indices ascend.
    #[inline]
    pub fn conversion(&mut self, index: u64, codes: &[Code; AXES], flags: &[Flags; AXES]) {
        if index < self.epoch {
            return;
        }
        for ((bins, code), flags) in self.axes.iter_mut().zip(codes).zip(flags) {
            if flags.is_none() {
                pass_over(bins, index);
                bins.push(code.0);
            }
        }
    }

    /// Takes good words of one axis (0 to 2), the first of which has index `first`. Indices
    /// ascend.
    ///
    /// For hosts: needs about 100 KiB of stack.
    pub fn run(&mut self, axis: usize, first: u64, codes: &[i32]) {
        let early = self.epoch.saturating_sub(first);
        let codes = usize::try_from(early)
            .ok()
            .and_then(|early| codes.get(early..));
        if let (Some(bins), Some(codes @ [_, ..])) = (self.axes.get_mut(axis), codes) {
            pass_over(bins, first + early);
            bins.push_slice(codes);
        }
    }

    /// What the bins hold of the conversions before `index`, which come to none that was taken;
    /// `None` if they have not begun.
    #[must_use]
    pub fn mark(&mut self, index: u64) -> Option<BinsMark> {
        if index <= self.epoch {
            return None;
        }
        Some(BinsMark {
            epoch: self.epoch,
            index,
            digests: self.axes.each_mut().map(|bins| {
                pass_over(bins, index);
                bins.digest()
            }),
        })
    }
}

impl Default for ProofBins {
    fn default() -> Self {
        Self::new()
    }
}

/// Whatever lies between the last word and the one at `index` is missing.
#[inline]
fn pass_over(bins: &mut BoardBins, index: u64) {
    let missing = index.saturating_sub(bins.next_index());
    if missing > 0 {
        bins.skip(missing);
    }
}

/// The words of `axis` in `batch` that have no flag, as places in the batch.
pub fn good_runs(batch: &Batch, axis: u8) -> impl Iterator<Item = Range<usize>> {
    let len = batch.codes.len();
    let bad = batch.flags.iter();
    let bad = bad.filter(move |flag| flag.axis == axis && !flag.flags.is_none());
    let bad = bad.map(|flag| usize::from(flag.conversion)).chain([len]);
    bad.scan(0, move |begin, bad| {
        // The board lists its flags in order; in any other, a run comes out empty.
        let run = *begin..bad.min(len);
        *begin = bad + 1;
        Some(run)
    })
    .filter(|run| !run.is_empty())
}

#[cfg(test)]
mod tests;
