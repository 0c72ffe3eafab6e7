//! Many samples at once: the same sums as one by one, bit for bit, in less time.
//!
//! A block's cumulative sums are computed first; then each level's differences that end in the
//! block are summed over contiguous rows of knots ([`kernels`](crate::kernels)), and last the
//! history takes over what pushing one by one would have left in it.

use crate::engine::{Engine, add_difference};
use crate::grid::{GROUND_LAGS, LEVEL_LAGS};
use crate::history::{GROUND, History, RING, last_taken_over, last_turn};
use crate::kernels::{self, Row, WIDEST, with_vectors};
use crate::knot::{Knot, Running};
use crate::statistic::Statistic;
use crate::sums::Sums;

/// Samples of a block. 2^11, which the kernels' partial sums allow for; and the sum of sums of that
/// many codes below 2^42 is below 2^63.
pub(crate) const BLOCK: usize = 2048;
/// Knots that the longest difference reaches back.
const REACH: u64 = 120;
/// Knots of a row: those from before the block, the last of which may itself be new, and a block's.
const ROOM: usize = REACH as usize + 1 + BLOCK;
/// Turns of a level below which its row is not worth collecting.
const FEW: u64 = 8;

/// Working space of a block, kept between the blocks of a slice.
pub(crate) struct Scratch {
    block: Words,
    row: Words,
    sum_halves: [i32; ROOM],
    double_halves: [i32; ROOM],
}

/// Cumulative sums modulo 2^64: of a block and the 120 knots before it, or of every `2^l`-th index.
struct Words {
    sums: [i64; ROOM],
    doubles: [i64; ROOM],
    len: usize,
    /// Position of the first knot at which a new difference ends.
    fresh: usize,
}

impl Words {
    const EMPTY: Self = Self {
        sums: [0; ROOM],
        doubles: [0; ROOM],
        len: 0,
        fresh: 0,
    };

    /// Begins with `knots` from before the block, at most 121.
    fn begin<K: Knot>(&mut self, knots: impl Iterator<Item = K>) {
        self.len = 0;
        for knot in knots.take(ROOM - BLOCK) {
            self.sums[self.len] = knot.sum_word() as i64;
            self.doubles[self.len] = knot.double_word() as i64;
            self.len += 1;
        }
        self.fresh = self.len;
    }

    /// Continues with the block's codes, after sums of which `running` are the last.
    #[inline(always)]
    fn accumulate<R: Running>(&mut self, running: R, codes: impl ExactSizeIterator<Item = i64>) {
        let (mut sum, mut double) = running.words();
        let room = self.sums[self.len..]
            .iter_mut()
            .zip(&mut self.doubles[self.len..]);
        let new = codes.len();
        for ((sums, doubles), code) in room.zip(codes) {
            double = double.wrapping_add(sum);
            sum = sum.wrapping_add_signed(code);
            *sums = sum as i64;
            *doubles = double as i64;
        }
        self.len += new;
    }

    /// Continues with every `2^level`-th knot of the block from position `from`, to `len` in all.
    #[inline(always)]
    fn thin_out(&mut self, block: &Self, from: usize, level: u32, len: usize) {
        let every = 1 << level;
        let sums = block.sums[..block.len].iter().skip(from).step_by(every);
        let doubles = block.doubles[..block.len].iter().skip(from).step_by(every);
        let room = self.sums[self.len..len]
            .iter_mut()
            .zip(&mut self.doubles[self.len..len]);
        for ((to_sum, to_double), (sum, double)) in room.zip(sums.zip(doubles)) {
            *to_sum = *sum;
            *to_double = *double;
        }
        self.len = len;
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
        halves: [&mut [i32; ROOM]; 2],
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
        let [sum_halves, double_halves] = halves;
        let sums = Row::new(&self.sums[..self.len], sum_halves);
        let doubles = Row::new(&self.doubles[..self.len], double_halves);
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

impl Scratch {
    pub(crate) const EMPTY: Self = Self {
        block: Words::EMPTY,
        row: Words::EMPTY,
        sum_halves: [0; ROOM],
        double_halves: [0; ROOM],
    };
}

/// Knots before and in a block, by index.
struct Knots<'a, K: Knot, const LEVELS: usize> {
    history: &'a History<K, LEVELS>,
    /// Sample count before the block.
    begin: u64,
    running: K::Running,
    block: &'a Words,
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
    /// Accepts at most [`BLOCK`] samples whose codes differ by at most `spread`. Before anything
    /// moves, shows `observe` the sample count after the block and how to find a knot.
    pub(crate) fn push_block(
        &mut self,
        scratch: &mut Scratch,
        codes: impl ExactSizeIterator<Item = i64>,
        spread: u64,
        observe: impl FnOnce(u64, &dyn Fn(u64) -> S::Knot),
    ) {
        let begin = self.next;
        let end = begin + codes.len() as u64;
        let start = self.start;
        let Scratch {
            block,
            row,
            sum_halves,
            double_halves,
        } = scratch;

        let oldest = (begin + 1).saturating_sub(REACH).max(start);
        block.begin((oldest..=begin).map(|index| self.history.get(begin, index)));
        let ground = &mut self.ground;
        let summed = with_vectors(
            #[inline(always)]
            || {
                block.accumulate(self.running, codes);
                block.add_to([sum_halves, double_halves], &GROUND_LAGS, ground, 1, 0)
            },
        );
        let (history, running) = (&self.history, self.running);
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
        for (level, all) in (1..).zip(&mut self.levels) {
            let Some(last) = last_turn(level, end) else {
                break;
            };
            let begun = start.div_ceil(1 << level);
            let first = last_turn(level, begin)
                .map_or(0, |turn| turn + 1)
                .max(begun);
            if first > last {
                continue;
            }
            let summed = last - first >= FEW && {
                // Multiples of the stride before the first sample of the block, and in it.
                let inside = (begin + 1).div_ceil(1 << level);
                let oldest = first.saturating_sub(REACH).max(begun);
                row.begin((oldest..inside.max(oldest)).map(|multiple| knot(multiple << level)));
                let position = (inside.max(oldest) << level) - begin;
                row.fresh = (first - oldest) as usize;
                with_vectors(
                    #[inline(always)]
                    || {
                        let (position, len) = (position as usize, (last + 1 - oldest) as usize);
                        row.thin_out(block, block.fresh - 1 + position, level, len);
                        let halves = [&mut *sum_halves, &mut *double_halves];
                        let stray = spread.saturating_mul(1 << level);
                        row.add_to(halves, &LEVEL_LAGS, all, 1 << level, stray)
                    },
                )
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
    fn advance(&mut self, block: &Words, end: u64) {
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
