//! The block under construction.

use std::ops::Range;

use inm_protocol::AXES;

use super::ranges::mark;

/// Consecutive samples that are still being gathered.
#[derive(Debug)]
pub(super) struct Building {
    pub first: u64,
    pub codes: [Vec<i32>; AXES],
    pub invalid: [Vec<Range<usize>>; AXES],
}

impl Building {
    pub fn len(&self) -> usize {
        self.codes[0].len()
    }

    /// Marks what of `suspect` (in samples of the record) lies in this block.
    pub fn mark_suspect(&mut self, axis: usize, suspect: &Range<u64>) {
        let len = self.len() as u64;
        let place = |index: u64| index.saturating_sub(self.first).min(len) as usize;
        mark(
            &mut self.invalid[axis],
            place(suspect.start)..place(suspect.end),
        );
    }
}
