//! Runs of a record in which nothing happens.

use std::ops::Range;

/// Where nothing happens.
pub struct Quiet {
    /// Runs of samples that are there.
    pub runs: Vec<Range<usize>>,
    /// The same where single gaps are none.
    pub whole: Vec<Range<usize>>,
}

impl Quiet {
    /// A stretch with the runs before and after it.
    pub fn about(runs: &[Range<usize>], samples: &Range<usize>) -> Range<usize> {
        let before = runs.iter().rev().find(|one| one.end == samples.start);
        let after = runs.iter().find(|one| one.start == samples.end);
        before.map_or(samples.start, |one| one.start)..after.map_or(samples.end, |one| one.end)
    }
}
