//! Many samples at once: the same sums as one by one, bit for bit, in less time.
//!
//! A block's cumulative sums are computed first; then each level's differences that end in the
//! block are summed over contiguous rows of knots ([`row`](crate::row)), each thinned out of the row
//! below it, and last the history takes over what pushing one by one would have left in it.

use crate::engine::{Engine, add_difference};
use crate::grid::{GROUND_LAGS, LEVEL, LEVEL_LAGS, LONGEST, REACH};
use crate::history::{GROUND, History, RING, last_taken_over, last_turn};
use crate::kernels::with_vectors;
use crate::knot::{Knot, Running};
use crate::packed::Packed;
use crate::row::{Line, Row};
use crate::sums::Sums;

/// Turns of a level below which its row is not worth collecting.
const FEW: u64 = 8;

/// Working space of a block, kept between the blocks of a slice.
pub(crate) struct Scratch {
    block: Row<LONGEST>,
    /// Of the level below and of the one at work, in turns.
    levels: [Row<LEVEL>; 2],
    packed: Packed,
}

impl Scratch {
    pub(crate) const EMPTY: Self = Self {
        block: Row::EMPTY,
        levels: [Row::EMPTY; 2],
        packed: Packed::EMPTY,
    };
}

/// Knots before and in a block, by index.
struct Knots<'a, K: Knot, const LEVELS: usize> {
    history: &'a History<K, LEVELS>,
    /// Sample count before the block.
    begin: u64,
    running: K::Running,
    block: &'a Row<LONGEST>,
}

impl<K: Knot, const LEVELS: usize> Knots<'_, K, LEVELS> {
    #[inline]
    fn get(&self, index: u64) -> K {
        if index <= self.begin {
            self.history.get(self.begin, index)
        } else {
            self.sums(index).knot()
        }
    }

    /// The cumulative sums at an index of the block.
    #[inline]
    fn sums(&self, index: u64) -> K::Running {
        let distance = index - self.begin;
        let at = self.block.fresh - 1 + distance as usize;
        let (sum, double) = (self.block.sums[at] as u64, self.block.doubles[at] as u64);
        self.running.later(distance, sum, double)
    }
}

impl<S: Sums, const LEVELS: usize> Engine<S, LEVELS> {
    /// Accepts at most [`BLOCK`](crate::grid::BLOCK) samples whose codes differ by at most `spread`. Before anything
    /// moves, shows `observe` the sample count after the block and how to find a knot.
    ///
    /// One function, as the loop over the levels hands rows and their oldest multiples from one to the next.
    pub(crate) fn push_block(
        &mut self,
        scratch: &mut Scratch,
        codes: impl ExactSizeIterator<Item = i64> + Clone,
        spread: u64,
        observe: impl FnOnce(u64, &dyn Fn(u64) -> S::Knot),
    ) {
        let begin = self.next;
        let end = begin + codes.len() as u64;
        let start = self.start;
        let Scratch {
            block,
            levels: [below, row],
            packed,
        } = scratch;
        let (mut below, mut row) = (below, row);
        let (history, running) = (&self.history, self.running);

        // The first multiple of the stride in the row of the level below, once there is one.
        let mut oldest_below = (begin + 1).saturating_sub(REACH).max(start);
        let ground = &mut self.ground;
        let mut line = Line {
            begin,
            sum: running.words().0 as i64,
            slope: 0,
        };
        let summed = with_vectors(
            #[inline(always)]
            || {
                line.slope = codes.clone().sum::<i64>() / codes.len().max(1) as i64;
                block.begin(history, line, oldest_below..=begin);
                block.accumulate::<S::Knot>(running, line.slope, codes);
                block.add_to(packed, &GROUND_LAGS, ground, 1, 0)
            },
        );
        let knots = Knots {
            history,
            begin,
            running,
            block,
        };
        let knot = |index| knots.get(index);
        if !summed {
            for (lag, sums) in GROUND_LAGS.into_iter().zip(&mut self.ground) {
                for index in begin + 1..=end {
                    add_difference(start, lag, index, knot, sums);
                }
            }
        }
        let mut many = true;
        for (level, all) in (1..).zip(&mut self.levels) {
            let Some(last) = last_turn(level, end) else {
                break;
            };
            let begun = start.div_ceil(1 << level);
            let first = last_turn(level, begin)
                .map_or(0, |turn| turn + 1)
                .max(begun);
            many &= first + FEW <= last;
            let summed = many && {
                let oldest = first.saturating_sub(REACH).max(begun);
                // The row below has every second of its own multiples for this one.
                let shared = oldest_below.div_ceil(2).max(oldest);
                let from = (2 * shared - oldest_below) as usize;
                let len = (last + 1 - oldest) as usize;
                oldest_below = oldest;
                let summed = with_vectors(
                    #[inline(always)]
                    || {
                        let older = (oldest..shared).map(|multiple| multiple << level);
                        row.begin(history, line, older);
                        if level == 1 {
                            row.thin_out::<S::Knot, _>(block, from, len);
                        } else {
                            row.thin_out::<S::Knot, _>(below, from, len);
                        }
                        row.fresh = (first - oldest) as usize;
                        let stray = spread.saturating_mul(1 << level);
                        row.add_to(packed, &LEVEL_LAGS, all, 1 << level, stray)
                    },
                );
                core::mem::swap(&mut below, &mut row);
                summed
            };
            if !summed {
                for index in (first..=last).map(|multiple| multiple << level) {
                    for (lag, sums) in LEVEL_LAGS.into_iter().zip(&mut *all) {
                        if !add_difference(start, lag << level, index, knot, sums) {
                            break;
                        }
                    }
                }
            }
        }
        observe(end, &knot);
        self.advance(block, end);
    }

    /// Brings the history and the position to `end`, as turn after turn would have.
    fn advance(&mut self, block: &Row<LONGEST>, end: u64) {
        let (begin, running) = (self.next, self.running);
        // From the top, so that a ring is read before it changes.
        for level in (1..=LEVELS as u32).rev() {
            let Some(last) = last_taken_over(level, end) else {
                continue;
            };
            let first = last_taken_over(level, begin).map_or(0, |taken| taken + 1);
            let first = first.max(self.start.div_ceil(1 << level));
            // Of more, the ring keeps the last.
            for multiple in first.max((last + 1).saturating_sub(RING as u64))..=last {
                let history = &self.history;
                let knot = Knots {
                    history,
                    begin,
                    running,
                    block,
                }
                .get(multiple << level);
                self.history.put_level(level, multiple << level, knot);
            }
        }
        for index in (begin + 1).max((end + 1).saturating_sub(GROUND as u64))..=end {
            let history = &self.history;
            let sums = Knots {
                history,
                begin,
                running,
                block,
            }
            .sums(index);
            self.history.put(index, sums.knot());
            self.running = sums;
        }
        self.samples += end - begin;
        self.next = end;
    }
}
