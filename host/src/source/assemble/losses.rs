//! The account of what is missing or must not be used.

use inm_protocol::AXES;

/// What the stream lost, and what it flagged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Losses {
    /// Samples an axis that are missing between the first and the last.
    pub lost_samples: u64,
    /// Places where samples are missing.
    pub gaps: u64,
    /// Batches that the board filled and the host did not receive intact.
    pub lost_batches: u64,
    /// Words flagged by the board, by axis.
    pub flagged: [u64; AXES],
    /// Times the board began again from index 0.
    pub restarts: u64,
    /// Frames left out: they had been there already, or came too late.
    pub left_out: u64,
}
