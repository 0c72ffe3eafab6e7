//! What a record consists of, what is missing, and what was heard on the way.

use crate::bins::unusable::Unusable;
use crate::clocks::Clocks;
use crate::source::Gap;

/// What a record consists of, for all axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Account {
    /// Samples that arrived, an axis.
    pub samples: u64,
    /// Samples known to be missing from all axes.
    pub lost: u64,
    /// Gaps in all axes.
    pub gaps: Vec<Gap>,
    /// The data rate by the clocks that were there.
    pub clocks: Option<Clocks>,
    /// What does not count of one axis alone, axis by axis; empty before the first block.
    pub unusable: Vec<Unusable>,
    /// News on the way, in words.
    pub news: Vec<String>,
}
