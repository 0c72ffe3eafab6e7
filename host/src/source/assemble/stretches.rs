//! The longest stretch of batches without a gap, by which the data rate is measured.

use inm_protocol::Batch;

/// The present stretch and the longest so far.
#[derive(Debug, Default)]
pub(super) struct Stretches {
    /// First index and stamp of the present one, in the board's own count.
    begun: (u64, u64),
    /// Conversions and ticks of the longest.
    longest: (u64, u64),
}

impl Stretches {
    /// The next batch; `goes_on` if no gap is ahead of it.
    pub(super) fn push(&mut self, batch: &Batch, goes_on: bool) {
        if !goes_on {
            self.begun = (batch.first, batch.stamp);
        }
        let ticks = batch.stamp.saturating_sub(self.begun.1);
        if ticks > self.longest.1 {
            self.longest = (batch.first.saturating_sub(self.begun.0), ticks);
        }
    }

    /// Conversions and ticks from the first batch of the longest to its last.
    pub(super) fn longest(&self) -> (u64, u64) {
        self.longest
    }
}
