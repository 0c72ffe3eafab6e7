//! Rows of neighbouring knots, whose differences are summed together.

use crate::history::History;
use crate::kernels::WIDEST;
use crate::knot::{Knot, Running};
use crate::packed::{Differences, Order, Packed, Second, Third};
use crate::statistic::Statistic;
use crate::sums::Sums;

/// Cumulative sums modulo 2^64: of a block and the 120 knots before it, or of every `2^l`-th index.
pub(crate) struct Row<const ROOM: usize> {
    /// Sums of the samples.
    pub(crate) sums: [i64; ROOM],
    /// Sums of these sums, where the knots keep them.
    pub(crate) doubles: [i64; ROOM],
    /// Knots that are there.
    pub(crate) len: usize,
    /// Position of the first knot at which a new difference ends.
    pub(crate) fresh: usize,
    /// How far the sums stray from the block's line to either side.
    stray: Stray,
}

/// A straight line through the sums, about which they stray: second differences are at most twice,
/// third ones at most four times the distance of the extremes, since a line has none.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    /// The index at which the block begins.
    pub(crate) begin: u64,
    /// The sum there.
    pub(crate) sum: i64,
    /// Mean of the block's codes.
    pub(crate) slope: i64,
}

#[derive(Clone, Copy)]
struct Stray {
    least: i64,
    most: i64,
}

impl Stray {
    const NONE: Self = Self { least: 0, most: 0 };

    #[inline(always)]
    fn include(&mut self, stray: i64) {
        self.least = self.least.min(stray);
        self.most = self.most.max(stray);
    }
}

impl<const ROOM: usize> Row<ROOM> {
    pub(crate) const EMPTY: Self = Self {
        sums: [0; ROOM],
        doubles: [0; ROOM],
        len: 0,
        fresh: 0,
        stray: Stray::NONE,
    };

    /// Begins with the knots at `indices`, not after the block's beginning.
    #[inline(always)]
    pub(crate) fn begin<K: Knot, const LEVELS: usize>(
        &mut self,
        history: &History<K, LEVELS>,
        line: Line,
        indices: impl Iterator<Item = u64>,
    ) {
        self.len = 0;
        self.stray = Stray::NONE;
        for (index, (sum, double)) in indices.zip(self.sums.iter_mut().zip(&mut self.doubles)) {
            let knot = history.get(line.begin, index);
            *sum = knot.sum_word() as i64;
            if K::DOUBLES {
                *double = knot.double_word() as i64;
            }
            let ahead = (line.begin - index) as i64;
            let line = line.sum.wrapping_sub(line.slope.wrapping_mul(ahead));
            self.stray.include(sum.wrapping_sub(line));
            self.len += 1;
        }
        self.fresh = self.len;
    }

    /// Continues with the block's codes, after sums of which `running` are the last.
    #[inline(always)]
    pub(crate) fn accumulate<K: Knot>(
        &mut self,
        running: K::Running,
        slope: i64,
        codes: impl ExactSizeIterator<Item = i64>,
    ) {
        let (mut sum, mut double) = running.words();
        let room = self.sums[self.len..].iter_mut();
        let room = room.zip(&mut self.doubles[self.len..]);
        self.len += codes.len();
        let mut line = sum;
        let mut stray = self.stray;
        for ((sums, doubles), code) in room.zip(codes) {
            if K::DOUBLES {
                double = double.wrapping_add(sum);
                *doubles = double as i64;
            }
            sum = sum.wrapping_add_signed(code);
            *sums = sum as i64;
            line = line.wrapping_add_signed(slope);
            stray.include(sum.wrapping_sub(line) as i64);
        }
        self.stray = stray;
    }

    /// Continues with every second knot of `below` from position `from` to, in all, `len`.
    #[inline(always)]
    pub(crate) fn thin_out<K: Knot, const BELOW: usize>(
        &mut self,
        below: &Row<BELOW>,
        from: usize,
        len: usize,
    ) {
        let thin = |to: &mut [i64; ROOM], all: &[i64; BELOW]| {
            let every_second = all[from..].chunks(2).map(|pair| pair[0]);
            for (to, word) in to[self.len..len].iter_mut().zip(every_second) {
                *to = word;
            }
        };
        thin(&mut self.sums, &below.sums);
        if K::DOUBLES {
            thin(&mut self.doubles, &below.doubles);
        }
        self.len = len;
        self.stray.include(below.stray.least);
        self.stray.include(below.stray.most);
    }

    /// Adds all differences that end at fresh knots. False, with nothing added, where they may be
    /// too large for the kernels.
    ///
    /// `stride_spread` bounds how far the sum can stray from a line within one stride.
    #[inline(always)]
    pub(crate) fn add_to<S: Sums>(
        &self,
        packed: &mut Packed,
        lags: &[u64],
        all: &mut [S],
        stride: u64,
        stride_spread: u64,
    ) -> bool {
        let range = self.stray.most.abs_diff(self.stray.least);
        // An inner sum is m second differences between any knots, not only those of the row.
        let between = range.saturating_add(stride_spread.saturating_mul(2));
        let inner = |lag: u64| between.saturating_mul(2).saturating_mul(lag * stride);
        let longest = lags.last().copied().unwrap_or(0);
        if range > WIDEST / 4 || (S::THIRD && inner(longest) > WIDEST) {
            return false;
        }
        let (sums, doubles) = (&self.sums[..self.len], &self.doubles[..self.len]);
        let allan = Differences::<Second>::new(sums, self.fresh, packed);
        add_all(Statistic::Allan, allan, lags, all, |_| 2 * range);
        if S::THIRD {
            let hadamard = Differences::<Third>::new(sums, self.fresh, packed);
            add_all(Statistic::Hadamard, hadamard, lags, all, |_| 4 * range);
            let modified = Differences::<Third>::new(doubles, self.fresh, packed);
            add_all(Statistic::Modified, modified, lags, all, inner);
        }
        true
    }
}

/// Adds the differences at each lag, of magnitude up to `bound`, to its sums.
#[inline(always)]
fn add_all<S: Sums, O: Order>(
    statistic: Statistic,
    mut differences: Differences<'_, O>,
    lags: &[u64],
    all: &mut [S],
    bound: impl Fn(u64) -> u64,
) {
    for (&lag, sums) in lags.iter().zip(all) {
        let Some((terms, squares)) = differences.squares(lag as usize, bound(lag)) else {
            break;
        };
        sums.add_total(statistic, squares, terms);
    }
}
