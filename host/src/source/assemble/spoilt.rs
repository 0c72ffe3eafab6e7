//! Which words must not be used: flagged ones, those near a clipped one, and those ahead of the notice
//! of a fault.

use std::ops::Range;

use inm_protocol::{AXES, Batch, Flags};

use super::building::Building;
use super::losses::Losses;
use super::ranges::mark;

/// Samples ahead of a clipped word that its filter ringing reaches (linear phase).
const GUARD_BEFORE: u64 = 31;

/// Samples after a clipped word until the converter is clean again (SBAS378D, page 12).
const GUARD_AFTER: u64 = 62;

/// What is still to be said of samples to come.
#[derive(Debug, Default)]
pub(super) struct Spoilt {
    /// By axis: samples before this index follow a clipped word.
    ringing_until: [u64; AXES],
    /// By axis: samples that a fault was noticed to have spoilt.
    suspect: [Range<u64>; AXES],
}

impl Spoilt {
    /// A fault has spoilt these samples of an axis, be they still to come; `None` if there is no such
    /// axis.
    pub(super) fn suspect(&mut self, axis: usize, range: Range<u64>) -> Option<&Range<u64>> {
        let suspect = self.suspect.get_mut(axis)?;
        *suspect = range;
        Some(suspect)
    }

    /// Marks what must not be used of `batch`, whose samples stand in `block` from `start` on, and near
    /// its clipped words; counts its flags.
    pub(super) fn mark(
        &mut self,
        block: &mut Building,
        start: usize,
        batch: &Batch,
        losses: &mut Losses,
    ) {
        let end = block.len();
        for (invalid, &until) in block.invalid.iter_mut().zip(&self.ringing_until) {
            mark(
                invalid,
                start..end.min(until.saturating_sub(block.first) as usize),
            );
        }
        for (axis, suspect) in self.suspect.iter().enumerate() {
            block.mark_suspect(axis, suspect);
        }
        for flag in &batch.flags {
            let axis = usize::from(flag.axis);
            let at = start + usize::from(flag.conversion);
            // Numbers from the wire: an impossible place is ignored, the frame was intact.
            let Some(invalid) = block.invalid.get_mut(axis).filter(|_| at < end) else {
                continue;
            };
            losses.flagged[axis] += 1;
            if flag.flags.has(Flags::OVER_RANGE) {
                let ahead = at.saturating_sub(GUARD_BEFORE as usize);
                mark(invalid, ahead..end.min(at + 1 + GUARD_AFTER as usize));
                self.ringing_until[axis] = block.first + at as u64 + 1 + GUARD_AFTER;
            } else {
                mark(invalid, at..at + 1);
            }
        }
    }
}
