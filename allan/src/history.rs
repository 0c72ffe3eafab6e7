//! The recent past of the cumulative sums, dense near the present and thinning out by octaves.
//!
//! Every index of the last 128 is kept in the *ground* ring. Ring `l` (from 1) keeps multiples of
//! `2^l`, the 64 of them that are 60 to 123 strides old; younger ones are found in the rings below.
//! So an octave of age costs 64 knots, and a level's three lags reach back 120 strides.
//!
//! Work is staggered: after sample count `n`, only level `trailing_zeros(n) + 1` acts, half a stride
//! after the index it acts on. At each such time it takes over the one knot that is 60 strides
//! old from the ring below, so that no conversion moves more than one knot between rings.

use crate::knot::Knot;

/// Indices kept in the ground ring.
pub(crate) const GROUND: usize = 128;
/// Knots in the ring of a level.
pub(crate) const RING: usize = 64;
/// Age in strides at which a level takes a knot over from below.
pub(crate) const HANDOVER: u64 = 60;
/// Age in strides up to which a ring is certain to hold a knot, wherever between two of the
/// level's turns the present lies: 123 at its last turn, which is half to one and a half strides
/// after the index of that turn.
const RETAINED: u64 = 123;

/// The level whose turn it is when the sample count reaches `next` (nonzero), and its index: the
/// multiple of the level's stride that lies half a stride back.
#[inline]
pub(crate) fn turn(next: u64) -> (u32, u64) {
    let half_stride_log2 = next.trailing_zeros();
    (half_stride_log2 + 1, next - (1 << half_stride_log2))
}

/// The newest index of `level` at sample count `next`, and whether its turn is still to come.
#[inline]
pub(crate) fn newest(level: u32, next: u64) -> (u64, bool) {
    let index = next >> level << level;
    (index, next - index < 1 << (level - 1))
}

/// The index, as a multiple of the stride, of the last turn that `level` has had at sample count
/// `next`; `None` before the first.
#[inline]
pub(crate) fn last_turn(level: u32, next: u64) -> Option<u64> {
    let (index, pending) = newest(level, next);
    (index >> level).checked_sub(u64::from(pending))
}

/// The multiple of its stride that `level` has taken over last at sample count `next`.
pub(crate) fn last_taken_over(level: u32, next: u64) -> Option<u64> {
    last_turn(level, next)?.checked_sub(HANDOVER)
}

/// Knots of the current run of samples, by index.
///
/// Slots that the current run has not filled yet hold what earlier runs left there;
/// [`History::tidied`] is rid of that.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct History<K, const LEVELS: usize> {
    ground: [K; GROUND],
    rings: [[K; RING]; LEVELS],
}

impl<K: Knot, const LEVELS: usize> History<K, LEVELS> {
    pub(crate) const EMPTY: Self = Self {
        ground: [K::ORIGIN; GROUND],
        rings: [[K::ORIGIN; RING]; LEVELS],
    };

    /// Records the knot of the present index.
    #[inline]
    pub(crate) fn put(&mut self, index: u64, knot: K) {
        self.ground[index as usize % GROUND] = knot;
    }

    /// The knot `age` samples before `next`, for ages below 128.
    #[inline]
    pub(crate) fn recent(&self, next: u64, age: u64) -> K {
        self.ground[next.wrapping_sub(age) as usize % GROUND]
    }

    /// The knot at `index`, seen from sample count `next`.
    ///
    /// For a difference of level `l` that has had its turn or is due for it, the index is a
    /// multiple of `2^l` at most 121.5 strides old, and so in a ring at or below `l`.
    #[inline]
    pub(crate) fn get(&self, next: u64, index: u64) -> K {
        let age = next - index;
        if age < GROUND as u64 {
            return self.ground[index as usize % GROUND];
        }
        // The ring in whose strides the age is 64 to 127, or the next where that is too old.
        let mut level = age.ilog2() - RING.ilog2();
        if age >> level >= RETAINED {
            level += 1;
        }
        self.rings[level as usize - 1][(index >> level) as usize % RING]
    }

    /// At `level`'s turn with `index`: takes the knot that has reached the level over, if it lies
    /// in the run that began at `start`, and returns it with its index.
    #[inline]
    pub(crate) fn take_over(
        &mut self,
        level: u32,
        next: u64,
        index: u64,
        start: u64,
    ) -> Option<(u64, K)> {
        let old = index
            .checked_sub(HANDOVER << level)
            .filter(|&old| old >= start)?;
        let knot = self.get(next, old);
        self.put_level(level, old, knot);
        Some((old, knot))
    }

    /// Puts the knot at `index` into the ring of `level`.
    #[inline]
    pub(crate) fn put_level(&mut self, level: u32, index: u64, knot: K) {
        self.rings[level as usize - 1][(index >> level) as usize % RING] = knot;
    }

    /// The knot at `index`, a multiple of the stride of `level` no older than its ring holds; level
    /// 0 is the ground.
    pub(crate) fn get_for(&self, level: u32, next: u64, index: u64) -> K {
        let multiple = index >> level;
        if level > 0 && last_taken_over(level, next).is_some_and(|last| multiple <= last) {
            self.rings[level as usize - 1][multiple as usize % RING]
        } else {
            self.get(next, index)
        }
    }

    /// Level (0 is the ground) and index of each knot that a history holds at sample count `next`
    /// of the run from `start`.
    pub(crate) fn slots(next: u64, start: u64) -> impl Iterator<Item = (u32, u64)> {
        let ground = start.max(next.saturating_sub(GROUND as u64 - 1))..=next;
        let levels = (1..=LEVELS as u32).flat_map(move |level| {
            let last = last_taken_over(level, next).into_iter();
            let multiples = last.flat_map(|last| last.saturating_sub(RING as u64 - 1)..=last);
            multiples.map(move |multiple| (level, multiple << level))
        });
        let levels = levels.filter(move |&(_, index)| index >= start);
        ground.map(|index| (0, index)).chain(levels)
    }

    /// A history at sample count `next` with `knot(level, index)` in every slot that belongs to the
    /// run from `start`, and nothing in the others.
    pub(crate) fn collected(next: u64, start: u64, knot: impl Fn(u32, u64) -> K) -> Self {
        let mut tidy = Self::EMPTY;
        for (level, index) in Self::slots(next, start) {
            match level {
                0 => tidy.put(index, knot(0, index)),
                _ => tidy.put_level(level, index, knot(level, index)),
            }
        }
        tidy
    }

    /// This history without the leftovers of earlier runs: a function of the samples alone.
    pub(crate) fn tidied(&self, next: u64, start: u64) -> Self {
        Self::collected(next, start, |level, index| self.get_for(level, next, index))
    }
}
