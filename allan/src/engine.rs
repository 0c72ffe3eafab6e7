//! The streaming estimator itself, the same for the board's bins and the host's.
//!
//! One sample costs the ground's averaging times and one turn of one level: the worst conversion is
//! 17 + 4 differences of each statistic, whatever the length of the record. A gap also settles the
//! levels whose turn was still to come, at most 4 differences a level, once.

use crate::grid::{GROUND_LAGS, LEVEL_LAGS};
use crate::history::{History, newest, turn};
use crate::knot::{Knot, Running};
use crate::statistic::{Estimate, Statistic};
use crate::sums::Sums;

/// Largest absolute index; skipping further stops here. 2^63 samples are 10^8 years.
pub(crate) const LAST_INDEX: u64 = 1 << 63;

/// Accumulated sums, the past they need, and the position in the record.
#[derive(Debug, Clone)]
pub(crate) struct Engine<S: Sums, const LEVELS: usize> {
    /// Absolute index of the first sample this state speaks for.
    pub(crate) first: u64,
    /// Absolute index of the next sample.
    pub(crate) next: u64,
    /// Absolute index at which the current run without gaps began.
    pub(crate) start: u64,
    /// Samples accepted.
    pub(crate) samples: u64,
    /// Cumulative sums at `next`.
    pub(crate) running: <S::Knot as Knot>::Running,
    pub(crate) history: History<S::Knot, LEVELS>,
    pub(crate) ground: [S; GROUND_LAGS.len()],
    pub(crate) levels: [[S; LEVEL_LAGS.len()]; LEVELS],
}

impl<S: Sums, const LEVELS: usize> Engine<S, LEVELS> {
    pub(crate) const fn new(first: u64) -> Self {
        Self {
            first,
            next: first,
            start: first,
            samples: 0,
            running: Running::ORIGIN,
            history: History::EMPTY,
            ground: [S::ZERO; GROUND_LAGS.len()],
            levels: [[S::ZERO; LEVEL_LAGS.len()]; LEVELS],
        }
    }

    /// Forgets everything and begins with `first`, in place. What the history's slots hold is not
    /// cleared: no run reads what another has left.
    pub(crate) fn restart(&mut self, first: u64) {
        let first = first.min(LAST_INDEX);
        self.first = first;
        self.next = first;
        self.start = first;
        self.samples = 0;
        self.running = Running::ORIGIN;
        self.history.put(first, self.running.knot());
        self.ground.fill(S::ZERO);
        self.levels.as_flattened_mut().fill(S::ZERO);
    }

    /// Accepts one sample. Returns the level whose turn it was and the knot it took over, if any.
    #[inline]
    pub(crate) fn push(&mut self, code: i64) -> Option<(u32, u64, S::Knot)> {
        self.running = self.running.advance(code);
        self.next += 1;
        self.samples += 1;
        let newest = self.running.knot();
        self.history.put(self.next, newest);
        self.work_ground(newest);
        self.work_level()
    }

    #[inline]
    fn work_ground(&mut self, newest: S::Knot) {
        let run = self.next - self.start;
        let knot = |age| self.history.recent(self.next, age);
        for (lag, sums) in GROUND_LAGS.into_iter().zip(&mut self.ground) {
            if run < 2 * lag {
                break;
            }
            sums.add_second([knot(2 * lag), knot(lag), newest]);
            if S::THIRD && run >= 3 * lag {
                sums.add_third([knot(3 * lag), knot(2 * lag), knot(lag), newest]);
            }
        }
    }

    #[inline]
    fn work_level(&mut self) -> Option<(u32, u64, S::Knot)> {
        let (level, index) = turn(self.next);
        if level as usize > LEVELS || index < self.start {
            return None;
        }
        self.add_level(level, index);
        self.history
            .take_over(level, self.next, index, self.start)
            .map(|(old, knot)| (level, old, knot))
    }

    /// Adds the differences of `level` that end at `index`.
    #[inline]
    fn add_level(&mut self, level: u32, index: u64) {
        let knot = |index| self.history.get(self.next, index);
        let all = &mut self.levels[level as usize - 1];
        for (lag, sums) in LEVEL_LAGS.into_iter().zip(all) {
            if !add_difference(self.start, lag << level, index, knot, sums) {
                break;
            }
        }
    }

    /// Passes over `missing` samples that were not seen. No difference will span them.
    pub(crate) fn skip(&mut self, missing: u64) {
        if missing == 0 {
            return;
        }
        for level in 1..=LEVELS as u32 {
            // No difference has room in the run, nor in those of the levels above.
            if self.next - self.start < 2 * (LEVEL_LAGS[0] << level) {
                break;
            }
            let (index, pending) = newest(level, self.next);
            if pending {
                self.add_level(level, index);
            }
        }
        let next = self.next.saturating_add(missing).min(LAST_INDEX);
        let next = next.max(self.next);
        self.running = self.running.coast(next - self.next);
        self.next = next;
        self.start = next;
        self.history.put(next, self.running.knot());
    }

    /// A level's sums with the differences included that have ended but not had their turn.
    pub(crate) fn settled(&self, level: u32) -> [S; LEVEL_LAGS.len()] {
        let mut all = self.levels[level as usize - 1];
        let (index, pending) = newest(level, self.next);
        if pending {
            let knot = |index| self.history.get(self.next, index);
            for (lag, sums) in LEVEL_LAGS.into_iter().zip(&mut all) {
                if !add_difference(self.start, lag << level, index, knot, sums) {
                    break;
                }
            }
        }
        all
    }

    /// Estimates of one statistic at every averaging time that has a difference, shortest first.
    pub(crate) fn points(&self, statistic: Statistic) -> impl Iterator<Item = Estimate> + '_ {
        let ground = GROUND_LAGS.into_iter().zip(&self.ground);
        let ground = ground.filter_map(move |(lag, sums)| sums.estimate(statistic, lag, 1));
        let levels = (1..=LEVELS as u32).flat_map(move |level| {
            let lags = LEVEL_LAGS.into_iter().zip(self.settled(level));
            lags.filter_map(move |(lag, sums)| sums.estimate(statistic, lag << level, 1 << level))
        });
        ground.chain(levels)
    }

    /// A fingerprint of the position, the cumulative sum of the codes and every accumulator.
    ///
    /// Words enter in the order: next index, run start, samples, sum of the codes modulo 2^64, then the ground's accumulators
    /// by lag and the levels' by level and lag, each as the number of terms and the limbs of the
    /// sum from the lowest. A word `w` takes the digest `h` to `(rotate_left(h, 29) ^ w) * K` with
    /// `K = 0x9E37_79B9_7F4A_7C15`, starting from zero; the result is `h ^ (h >> 32)`. Every step is
    /// a bijection of `h`, so a difference in a single word always shows.
    pub(crate) fn digest(&self) -> u64 {
        const MULTIPLIER: u64 = 0x9E37_79B9_7F4A_7C15;
        let enter =
            |digest: u64, word: u64| (digest.rotate_left(29) ^ word).wrapping_mul(MULTIPLIER);
        let position = [
            self.next,
            self.start,
            self.samples,
            self.running.knot().sum_word(),
        ];
        let mut digest = position.into_iter().fold(0, enter);
        for sums in self.ground.iter().chain(self.levels.as_flattened()) {
            digest = sums.fold_words(digest, enter);
        }
        digest ^ digest >> 32
    }
}

/// Adds the differences at averaging factor `m` that end at `end`, as far as they lie in the run
/// from `start`; false if none does.
#[inline]
pub(crate) fn add_difference<S: Sums>(
    start: u64,
    m: u64,
    end: u64,
    knot: impl Fn(u64) -> S::Knot,
    sums: &mut S,
) -> bool {
    let run = end.saturating_sub(start);
    if run < 2 * m {
        return false;
    }
    let recent = [knot(end - 2 * m), knot(end - m), knot(end)];
    sums.add_second(recent);
    if S::THIRD && run >= 3 * m {
        sums.add_third([knot(end - 3 * m), recent[0], recent[1], recent[2]]);
    }
    true
}

/// Compares what has a meaning: history that no turn will use any more may differ.
impl<S: Sums, const LEVELS: usize> PartialEq for Engine<S, LEVELS> {
    fn eq(&self, other: &Self) -> bool {
        let position = |engine: &Self| (engine.first, engine.next, engine.start, engine.samples);
        let history = |engine: &Self| engine.history.tidied(engine.next, engine.start);
        position(self) == position(other)
            && self.running == other.running
            && self.ground == other.ground
            && self.levels == other.levels
            && history(self) == history(other)
    }
}
