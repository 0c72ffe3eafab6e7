//! Merging bins of adjacent parts of a record: [a, b) and [b, c) give exactly [a, c).
//!
//! The sums of both parts stand. What is missing are the differences that span `b`: their older
//! knots come from the left part's history, the others from the right part's head, moved to where
//! the left part's cumulative sums had arrived at `b`.

use core::fmt;

use crate::bins::Bins;
use crate::engine::Engine;
use crate::grid::{GROUND_LAGS, LEVEL_LAGS};
use crate::head::Head;
use crate::history::{History, newest};
use crate::knot::PairKnot;
use crate::sums::{FamilySums, Sums};

/// Two states do not follow each other: the index after the left one's last sample is not the
/// right one's first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotAdjacent {
    /// [`Bins::next_index`] of the left state.
    pub left_next: u64,
    /// [`Bins::first_index`] of the right state.
    pub right_first: u64,
}

impl fmt::Display for NotAdjacent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the left part ends before index {} but the right part begins at index {}",
            self.left_next, self.right_first
        )
    }
}

impl core::error::Error for NotAdjacent {}

impl<const LEVELS: usize> Bins<LEVELS> {
    /// Appends the bins of the part of the record that follows: the result is the same bits as if
    /// its samples had been pushed here, and merging is associative.
    ///
    /// # Errors
    ///
    /// [`NotAdjacent`] when `right` does not begin where these bins end; nothing is changed then.
    pub fn merge(&mut self, right: &Self) -> Result<(), NotAdjacent> {
        let (left_next, right_first) = (self.engine.next, right.engine.first);
        if left_next != right_first {
            return Err(NotAdjacent {
                left_next,
                right_first,
            });
        }
        let seam = Seam::new(self, right);
        let (ground, levels) = seam.spanning();
        let head = seam.head(&self.head);
        let history = seam.history();
        let start = seam.start();

        let engine = &mut self.engine;
        merge_sums(&mut engine.ground, &ground);
        merge_sums(&mut engine.ground, &right.engine.ground);
        for (level, (spanning, right)) in engine
            .levels
            .iter_mut()
            .zip(levels.iter().zip(&right.engine.levels))
        {
            merge_sums(level, spanning);
            merge_sums(level, right);
        }
        let distance = right.engine.next - left_next;
        engine.running = engine.running.continued(right.engine.running, distance);
        engine.samples += right.engine.samples;
        engine.next = right.engine.next;
        engine.start = start;
        engine.history = history;
        self.head = head;
        Ok(())
    }
}

fn merge_sums(into: &mut [FamilySums], from: &[FamilySums]) {
    for (into, from) in into.iter_mut().zip(from) {
        into.merge(from);
    }
}

/// Both parts as seen from the index where they meet.
struct Seam<'a, const LEVELS: usize> {
    left: &'a Engine<FamilySums, LEVELS>,
    right: &'a Engine<FamilySums, LEVELS>,
    /// The right part's head with everything filed that its first run has.
    right_head: Head<LEVELS>,
    /// Index at which the parts meet.
    at: u64,
    /// Where the right part's first run ends, or has got to.
    run_end: u64,
    /// Whether that run is over.
    run_is_over: bool,
}

impl<'a, const LEVELS: usize> Seam<'a, LEVELS> {
    fn new(left: &'a Bins<LEVELS>, right: &'a Bins<LEVELS>) -> Self {
        let mut right_head = right.head.clone();
        right_head.close(right.engine.next, &right.engine.history);
        Self {
            left: &left.engine,
            right: &right.engine,
            at: right.engine.first,
            run_end: right_head.end.unwrap_or(right.engine.next),
            run_is_over: right.head.end.is_some(),
            right_head,
        }
    }

    /// Where the merged record's current run begins.
    fn start(&self) -> u64 {
        if self.run_is_over {
            self.right.start
        } else {
            self.left.start
        }
    }

    /// The merged record's knot at an index of the right part, given that part's own.
    fn moved(&self, index: u64, knot: PairKnot) -> PairKnot {
        knot.continuing(self.left.running, index - self.at)
    }

    /// The merged record's knot at an index of the run across the seam.
    fn knot(&self, index: u64) -> PairKnot {
        if index <= self.at {
            self.left.history.get(self.at, index)
        } else {
            self.moved(index, self.right_head.get(index))
        }
    }

    /// The differences that neither part has: those that span the seam, and those of the left part
    /// that still wait for their level's turn.
    fn spanning(
        &self,
    ) -> (
        [FamilySums; GROUND_LAGS.len()],
        [[FamilySums; LEVEL_LAGS.len()]; LEVELS],
    ) {
        let mut ground = [FamilySums::ZERO; GROUND_LAGS.len()];
        for (sums, m) in ground.iter_mut().zip(GROUND_LAGS) {
            for end in self.at + 1..=self.run_end.min(self.at + 3 * m) {
                self.add(m, end, sums);
            }
        }
        let mut levels = [[FamilySums::ZERO; LEVEL_LAGS.len()]; LEVELS];
        for (level, all) in (1..).zip(&mut levels) {
            let (index, pending) = newest(level, self.at);
            let first = (index >> level) + u64::from(!pending);
            // While the run goes on, the last index may still be waiting for its turn.
            let (index, pending) = newest(level, self.run_end);
            let waiting = pending && !self.run_is_over;
            let ends = first..(index >> level) + u64::from(!waiting);
            for (sums, lag) in all.iter_mut().zip(LEVEL_LAGS) {
                for end in ends
                    .clone()
                    .take_while(|end| end << level < self.at + ((3 * lag) << level))
                {
                    self.add(lag << level, end << level, sums);
                }
            }
        }
        (ground, levels)
    }

    /// Adds the differences that end at `end` and begin before the seam.
    fn add(&self, m: u64, end: u64, sums: &mut FamilySums) {
        let spans = |span: u64| {
            end.checked_sub(span)
                .is_some_and(|begin| begin >= self.left.start && begin < self.at)
        };
        let knot = |lags: u64| self.knot(end - lags * m);
        if spans(2 * m) {
            sums.add_second([knot(2), knot(1), knot(0)]);
        }
        if spans(3 * m) {
            sums.add_third([knot(3), knot(2), knot(1), knot(0)]);
        }
    }

    /// The merged record's head.
    fn head(&self, left: &Head<LEVELS>) -> Head<LEVELS> {
        let mut head = left.clone();
        if head.end.is_none() {
            head.extend(self.at, self.run_end, self.run_is_over, |index| {
                self.knot(index)
            });
        }
        head
    }

    /// The merged record's history.
    fn history(&self) -> History<PairKnot, LEVELS> {
        History::collected(self.right.next, self.start(), |level, index| {
            if index <= self.at && !self.run_is_over {
                self.left.history.get_for(level, self.at, index)
            } else {
                self.moved(
                    index,
                    self.right.history.get_for(level, self.right.next, index),
                )
            }
        })
    }
}
