//! Many samples at once: the same sums as one by one, bit for bit, in less time.
//!
//! A block's knots are computed first; then each level's differences that end in the block are
//! summed over contiguous rows of knots ([`kernels`](crate::kernels)), and last the history takes
//! over what pushing one by one would have left in it.

use crate::engine::{Engine, add_difference};
use crate::grid::{GROUND_LAGS, LEVEL_LAGS};
use crate::history::{last_taken_over, last_turn};
use crate::kernels::{self, Row, WIDEST, with_vectors};
use crate::knot::{Knot, Running};
use crate::statistic::Statistic;
use crate::sums::Sums;

/// Samples of a block. 2^11, which the kernels' partial sums allow for.
pub(crate) const BLOCK: usize = 2048;
/// Knots before a block that its differences reach back to.
const REACH: usize = 120;
/// Turns of a level below which its row is not worth collecting.
const FEW: u64 = 8;

/// Knots of one stride next to each other: those that differences need, then the new ones.
struct Rows {
    sums: [i64; REACH + BLOCK],
    doubles: [i64; REACH + BLOCK],
    sum_halves: [i32; REACH + BLOCK],
    double_halves: [i32; REACH + BLOCK],
    len: usize,
    /// Position of the first knot at which a new difference ends.
    fresh: usize,
}

impl Rows {
    const EMPTY: Self = Self {
        sums: [0; REACH + BLOCK],
        doubles: [0; REACH + BLOCK],
        sum_halves: [0; REACH + BLOCK],
        double_halves: [0; REACH + BLOCK],
        len: 0,
        fresh: 0,
    };

    fn collect<K: Knot>(&mut self, fresh: usize, knots: impl Iterator<Item = K>) {
        self.fresh = fresh;
        self.len = 0;
        for (at, knot) in knots.take(REACH + BLOCK).enumerate() {
            let (sum, double) = (knot.sum_word(), knot.double_word());
            self.sums[at] = sum as i64;
            self.doubles[at] = double as i64;
            self.sum_halves[at] = sum as i32;
            self.double_halves[at] = double as i32;
            self.len = at + 1;
        }
    }

    /// How far the sums stray from a straight line: second differences are at most twice, third
    /// ones at most four times as large, since a line has none.
    #[inline(always)]
    fn range(&self) -> u64 {
        let sums = &self.sums[..self.len];
        let (Some(&first), Some(&last)) = (sums.first(), sums.last()) else {
            return 0;
        };
        let slope = last.wrapping_sub(first) / (self.len as i64 - 1).max(1);
        let (mut least, mut most, mut line) = (0_i64, 0_i64, first);
        for &sum in sums {
            let stray = sum.wrapping_sub(line);
            least = least.min(stray);
            most = most.max(stray);
            line = line.wrapping_add(slope);
        }
        most.abs_diff(least)
    }

    /// Adds all differences that end at fresh knots. False, with nothing added, where they may be
    /// too large for the kernels.
    ///
    /// `stride_spread` bounds how far the sum can stray from a line within one stride.
    #[inline(always)]
    fn add_to<S: Sums>(
        &self,
        lags: &[u64],
        all: &mut [S],
        stride: u64,
        stride_spread: u64,
    ) -> bool {
        let range = self.range();
        // An inner sum is m second differences between any knots, not only those of the row.
        let between = range.saturating_add(stride_spread.saturating_mul(2));
        let inner = |lag: u64| between.saturating_mul(2).saturating_mul(lag * stride);
        let longest = lags.last().copied().unwrap_or(0);
        if range > WIDEST / 4 || (S::THIRD && inner(longest) > WIDEST) {
            return false;
        }
        let sums = Row {
            words: &self.sums[..self.len],
            halves: &self.sum_halves[..self.len],
        };
        let doubles = Row {
            words: &self.doubles[..self.len],
            halves: &self.double_halves[..self.len],
        };
        for (&lag, all) in lags.iter().zip(all) {
            let at = lag as usize;
            let from = self.fresh.max(2 * at);
            if from >= self.len {
                break;
            }
            let squares = kernels::second_differences(sums, at, from, 2 * range);
            all.add_total(Statistic::Allan, squares, (self.len - from) as u64);
            let from = self.fresh.max(3 * at);
            if !S::THIRD || from >= self.len {
                continue;
            }
            let terms = (self.len - from) as u64;
            let squares = kernels::third_differences(sums, at, from, 4 * range);
            all.add_total(Statistic::Hadamard, squares, terms);
            let squares = kernels::third_differences(doubles, at, from, inner(lag));
            all.add_total(Statistic::Modified, squares, terms);
        }
        true
    }
}

impl<S: Sums, const LEVELS: usize> Engine<S, LEVELS> {
    /// Accepts at most [`BLOCK`] samples whose codes differ by at most `spread`. Calls `file` with
    /// the level, index and knot of each knot that a level takes over (level 0: of each new index).
    pub(crate) fn push_block(
        &mut self,
        codes: impl ExactSizeIterator<Item = i64>,
        spread: u64,
        mut file: impl FnMut(u32, u64, S::Knot),
    ) {
        let begin = self.next;
        let end = begin + codes.len() as u64;
        let mut knots = [S::Knot::ORIGIN; BLOCK];
        let mut running = self.running;
        for (slot, code) in knots.iter_mut().zip(codes) {
            running = running.advance(code);
            *slot = running.knot();
        }
        let history = &self.history;
        // The knot at an index up to `end`, for the differences of a level that end in the block.
        let knot = |index: u64| {
            if index > begin {
                knots[(index - begin - 1) as usize]
            } else {
                history.get(begin, index)
            }
        };

        let mut rows = Rows::EMPTY;
        with_vectors(
            #[inline(always)]
            || {
                let oldest = begin.saturating_sub(REACH as u64 - 1).max(self.start);
                let fresh = begin + 1 - oldest;
                rows.collect(fresh as usize, (oldest..=end).map(knot));
                if !rows.add_to(&GROUND_LAGS, &mut self.ground, 1, 0) {
                    for (lag, sums) in GROUND_LAGS.into_iter().zip(&mut self.ground) {
                        for end in begin + 1..=end {
                            add_difference(self.start, lag, end, knot, sums);
                        }
                    }
                }
            },
        );
        for (level, all) in (1..).zip(&mut self.levels) {
            let Some(last) = last_turn(level, end) else {
                break;
            };
            let first = last_turn(level, begin).map_or(0, |turn| turn + 1);
            let first = first.max(self.start.div_ceil(1 << level));
            if first > last {
                continue;
            }
            let collected = last - first >= FEW
                && with_vectors(
                    #[inline(always)]
                    || {
                        let oldest = first
                            .saturating_sub(REACH as u64)
                            .max(self.start.div_ceil(1 << level));
                        rows.collect(
                            (first - oldest) as usize,
                            (oldest..=last).map(|multiple| knot(multiple << level)),
                        );
                        rows.add_to(
                            &LEVEL_LAGS,
                            all,
                            1 << level,
                            spread.saturating_mul(1 << level),
                        )
                    },
                );
            if !collected {
                for multiple in first..=last {
                    for (lag, sums) in LEVEL_LAGS.into_iter().zip(&mut *all) {
                        if !add_difference(self.start, lag << level, multiple << level, knot, sums)
                        {
                            break;
                        }
                    }
                }
            }
        }
        self.advance_history(&knots, end, &mut file);
        self.running = running;
        self.samples += end - begin;
        self.next = end;
    }

    /// Moves knots between the rings as turn after turn would have, from the top so that a ring is
    /// read before it changes.
    fn advance_history(
        &mut self,
        knots: &[S::Knot],
        end: u64,
        file: &mut impl FnMut(u32, u64, S::Knot),
    ) {
        let begin = self.next;
        for level in (1..=LEVELS as u32).rev() {
            let Some(last) = last_taken_over(level, end) else {
                continue;
            };
            let first = last_taken_over(level, begin)
                .map_or(0, |taken| taken + 1)
                .max(self.start.div_ceil(1 << level));
            for multiple in first..=last {
                let index = multiple << level;
                let knot = if index > begin {
                    knots[(index - begin - 1) as usize]
                } else {
                    self.history.get(begin, index)
                };
                self.history.put_level(level, index, knot);
                file(level, index, knot);
            }
        }
        for (index, &knot) in (begin + 1..=end).zip(knots) {
            self.history.put(index, knot);
            file(0, index, knot);
        }
    }
}
