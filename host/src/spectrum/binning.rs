//! How to bin, and what is binned together.

use super::cosine::Run;
use std::ops::RangeInclusive;

/// How to bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Bins an octave.
    pub bins_per_octave: f64,
    /// Whole segments that a level must have for its bins to be preferred to coarser ones.
    pub segments: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            bins_per_octave: 16.0,
            segments: 12,
        }
    }
}

/// Where a bin's estimate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Segments at the sample rate over `8^level`.
    Segments {
        /// Number of decimations.
        level: usize,
    },
    /// Cosine transforms of whole gap-free runs.
    Record,
}

/// Bins of one source, in ascending order.
pub(super) enum Group {
    /// Bins of a level, each over some bins of its segments.
    Level {
        level: usize,
        bins: Vec<RangeInclusive<usize>>,
    },
    /// Bins over ordinates of runs: run and ordinate.
    Record {
        level: usize,
        runs: Vec<Run>,
        bins: Vec<Vec<(usize, usize)>>,
    },
}

impl Group {
    /// Number of decimations ahead of its source.
    pub(super) fn level(&self) -> usize {
        match self {
            Self::Level { level, .. } | Self::Record { level, .. } => *level,
        }
    }

    /// Number of bins.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Level { bins, .. } => bins.len(),
            Self::Record { bins, .. } => bins.len(),
        }
    }
}
