//! The first knots of a record, kept so that another record can be merged in front of it.
//!
//! The mirror of [`History`]: every index of the first 128, then 64 multiples of `2^l` for each
//! level, 60 to 123 strides from the beginning. A level's knots are filed as it takes them over;
//! when the first run ends, the rest of them is filed at once.

use crate::history::{HANDOVER, History, last_taken_over};
use crate::knot::{Knot, PairKnot};

/// Indices kept one by one.
const GROUND: u64 = 128;
/// Multiples of its stride that a level keeps, and which.
const RING: usize = 64;
const NEAREST: u64 = HANDOVER;
const FURTHEST: u64 = 123;

/// Knots of the first run of a record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Head<const LEVELS: usize> {
    /// Absolute index of the record's first sample.
    first: u64,
    /// Where the first run ended, once it has.
    pub(crate) end: Option<u64>,
    ground: [PairKnot; GROUND as usize],
    rings: [[PairKnot; RING]; LEVELS],
}

impl<const LEVELS: usize> Head<LEVELS> {
    pub(crate) const fn new(first: u64) -> Self {
        Self {
            first,
            end: None,
            ground: [PairKnot::ORIGIN; GROUND as usize],
            rings: [[PairKnot::ORIGIN; RING]; LEVELS],
        }
    }

    /// Files the knot of a new index.
    #[inline]
    pub(crate) fn file_ground(&mut self, index: u64, knot: PairKnot) {
        if index - self.first < GROUND && self.end.is_none() {
            self.ground[(index % GROUND) as usize] = knot;
        }
    }

    /// Files the knot that `level` took over.
    #[inline]
    pub(crate) fn file(&mut self, level: u32, index: u64, knot: PairKnot) {
        let multiple = index >> level;
        let distance = multiple - (self.first >> level);
        if (NEAREST..=FURTHEST).contains(&distance) && self.end.is_none() {
            self.rings[level as usize - 1][multiple as usize % RING] = knot;
        }
    }

    /// Ends the first run at `next`: files what the levels have not taken over yet.
    pub(crate) fn close(&mut self, next: u64, history: &History<PairKnot, LEVELS>) {
        self.file_levels(
            next,
            |level| Some(next >> level),
            |index| history.get(next, index),
        );
        self.end = self.end.or(Some(next));
    }

    /// Files what arrives while a record with an open head goes on from sample count `known` to
    /// `next`, the knots being found by `knot`; and ends the run there if `ends`.
    pub(crate) fn extend(
        &mut self,
        known: u64,
        next: u64,
        ends: bool,
        knot: impl Fn(u64) -> PairKnot,
    ) {
        for index in known + 1..=next.min(self.first + GROUND - 1) {
            self.file_ground(index, knot(index));
        }
        if ends {
            self.file_levels(known, |level| Some(next >> level), knot);
            self.end = self.end.or(Some(next));
        } else {
            self.file_levels(known, |level| last_taken_over(level, next), knot);
        }
    }

    /// Files the multiples that follow the last taken over at sample count `known`, up to `last`.
    fn file_levels(
        &mut self,
        known: u64,
        last: impl Fn(u32) -> Option<u64>,
        knot: impl Fn(u64) -> PairKnot,
    ) {
        for level in 1..=LEVELS as u32 {
            let begin = self.first >> level;
            let from = last_taken_over(level, known).map_or(0, |taken| taken + 1);
            let Some(last) = last(level) else { continue };
            for multiple in from.max(begin + NEAREST)..=last.min(begin + FURTHEST) {
                self.file(level, multiple << level, knot(multiple << level));
            }
        }
    }

    /// Level (0 is the ground) and index of each knot that the head of a record holds at sample count
    /// `next`, ascending.
    pub(crate) fn slots(&self, next: u64) -> impl Iterator<Item = (u32, u64)> + use<LEVELS> {
        let (first, end) = (self.first, self.end);
        let ground = first..=end.unwrap_or(next).min(first + GROUND - 1);
        let levels = (1..=LEVELS as u32).flat_map(move |level| {
            let begin = first >> level;
            let last = match end {
                Some(end) => Some(end >> level),
                None => last_taken_over(level, next),
            };
            let multiples = last
                .into_iter()
                .flat_map(move |last| begin + NEAREST..=last.min(begin + FURTHEST));
            multiples.map(move |multiple| (level, multiple << level))
        });
        ground.map(|index| (0, index)).chain(levels)
    }

    /// The knot in the slot of a level and index.
    pub(crate) fn get_for(&self, level: u32, index: u64) -> PairKnot {
        match level {
            0 => self.ground[(index % GROUND) as usize],
            _ => self.rings[level as usize - 1][(index >> level) as usize % RING],
        }
    }

    /// Fills the slot of a level and index.
    pub(crate) fn put(&mut self, level: u32, index: u64, knot: PairKnot) {
        match level {
            0 => self.ground[(index % GROUND) as usize] = knot,
            _ => self.rings[level as usize - 1][(index >> level) as usize % RING] = knot,
        }
    }

    /// The knot at `index`, in the first run of a closed head.
    ///
    /// For a difference of level `l` that began before this record, the index is a multiple of
    /// `2^l` and less than 120 strides into it.
    pub(crate) fn get(&self, index: u64) -> PairKnot {
        if index - self.first < GROUND {
            return self.ground[(index % GROUND) as usize];
        }
        let mut level = 1;
        while (index >> level) - (self.first >> level) > FURTHEST {
            level += 1;
        }
        self.rings[level as usize - 1][(index >> level) as usize % RING]
    }
}
