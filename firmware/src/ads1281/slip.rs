//! Whether the bit stream has slipped: the level doubled or halved from one word to the next,
//! and stayed.
//!
//! A glitch on SCLK shifts every later word by a bit, since no CS realigns it. The redundant
//! sign bit shows that on a signal around zero; an axis with an offset keeps its sign, and
//! there the level tells. The detector compares each word with the running level and spread:
//!
//! * it knows nothing, and says so by staying silent, until it has learned the level, and
//!   where the level is less than [`MIN_RATIO`] times the spread: noise around zero;
//! * a jump has to hit twice or half the level within a few spreads, without a word in between,
//!   as no signal behind the converter's filter can (its step response rings for 62 words),
//!   and has to stay for [`CONFIRM`] words.
//!
//! The averages forget over 64 words. Integer arithmetic, a few operations a word.

/// Words from which level and spread are learned.
const LEARN: u32 = 64;
/// Weight of a new word in level and spread: 2^-6.
const FORGET: u32 = 6;
/// Fraction bits of level and spread.
const FRACTION: u32 = 8;
/// Words that a jump must last.
pub const CONFIRM: u32 = 16;
/// Words in a row, far from any expectation, after which the level is learned anew.
const RELEARN: u32 = 32;
/// Half-width of the usual, in mean absolute deviations: 4 standard deviations of Gaussian
/// noise, which one word in 16000 exceeds, with a sixty-fourth of the level beside it for drift.
const BAND: i64 = 5;
/// Least level in mean absolute deviations, for jumps by two to stand out of the noise: the
/// bands around the level and, half as wide, around its half must not meet, which asks for 16.
pub const MIN_RATIO: i64 = 20;
/// Least level in steps of the 31-bit value, for a signal without noise.
const MIN_LEVEL: i64 = 1 << 12;

/// How the words differ from what they were.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Slip {
    /// Twice the level: a bit was lost and a later one taken in.
    Doubled,
    /// Half the level: a bit came twice or too early.
    Halved,
}

/// What one word says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Verdict {
    /// Nothing.
    Usual,
    /// It stands near nothing that is expected.
    Strange,
    /// It stands where a slip would put it.
    Suspect(Slip),
    /// So did the last [`CONFIRM`] words.
    Slipped(Slip),
}

/// Running level and spread of one axis.
#[derive(Debug, Clone, Copy, Default)]
pub struct SlipDetector {
    /// Running mean, with [`FRACTION`] bits.
    level: i64,
    /// Running mean absolute deviation, with [`FRACTION`] bits.
    spread: i64,
    learned: u32,
    suspect: Option<(Slip, u32)>,
    /// Words in a row near nothing that is expected.
    strangers: u32,
}

impl SlipDetector {
    /// A detector that knows nothing.
    pub const fn new() -> Self {
        Self {
            level: 0,
            spread: 0,
            learned: 0,
            suspect: None,
            strangers: 0,
        }
    }

    /// Whether the last word stood where a slip would put it.
    pub fn suspects(&self) -> bool {
        self.suspect.is_some()
    }

    /// Forgets a suspicion, keeps the level: after a realignment the words must stand where
    /// they stood before.
    pub fn realigned(&mut self) {
        self.suspect = None;
        self.strangers = 0;
    }

    /// Takes the 31-bit value of the next good word.
    #[inline]
    pub fn push(&mut self, value: i32) -> Verdict {
        let value = i64::from(value) << FRACTION;
        let distance = value - self.level;
        if self.learned < LEARN {
            self.learn(distance);
            return Verdict::Usual;
        }
        let band = BAND * self.spread + (self.level.abs() >> 6);
        if distance.abs() <= band {
            self.suspect = None;
            self.strangers = 0;
            self.follow(distance);
            return Verdict::Usual;
        }
        self.unusual(value, distance, band)
    }

    #[cold]
    fn unusual(&mut self, value: i64, distance: i64, band: i64) -> Verdict {
        if let Some(slip) = self.slip_of(value, band) {
            let count = match self.suspect {
                Some((before, count)) if before == slip => count + 1,
                _ => 1,
            };
            self.suspect = Some((slip, count));
            return if count < CONFIRM {
                Verdict::Suspect(slip)
            } else {
                Verdict::Slipped(slip)
            };
        }
        self.suspect = None;
        self.strangers += 1;
        if self.strangers >= RELEARN {
            *self = Self::new();
        } else {
            // A signal that grows lively has to widen the spread, a single outlier must not.
            self.follow(distance.clamp(-band, band));
        }
        Verdict::Strange
    }

    /// Which slip would have put the level at `value`.
    fn slip_of(&self, value: i64, band: i64) -> Option<Slip> {
        let known = self.level.abs() >= (MIN_LEVEL << FRACTION).max(MIN_RATIO * self.spread);
        // The word in which the slip happened may look like anything; a signal on its way
        // through the filter looks strange for longer.
        let at_once = self.suspect.is_some() || self.strangers <= 1;
        if !known || !at_once {
            return None;
        }
        let near = |target: i64, band: i64| (value - target).abs() <= band;
        if near(wrapped(2 * self.level), 2 * band) {
            Some(Slip::Doubled)
        } else if near(self.level / 2, band / 2) {
            Some(Slip::Halved)
        } else {
            None
        }
    }

    /// Plain averages over the words so far.
    fn learn(&mut self, distance: i64) {
        self.learned += 1;
        let count = i64::from(self.learned);
        self.level += distance / count;
        if self.learned > 1 {
            self.spread += (distance.abs() - self.spread) / (count - 1);
        }
    }

    /// Exponentially forgetting averages.
    fn follow(&mut self, distance: i64) {
        self.level += distance >> FORGET;
        self.spread += (distance.abs() - self.spread) >> FORGET;
    }
}

/// `level` as far as 31 bits hold it; the bit that a left shift loses is the sign.
const fn wrapped(level: i64) -> i64 {
    const LOST: u32 = 64 - 31 - FRACTION;
    level << LOST >> LOST
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform noise of +-`amplitude` by a 64-bit linear congruential generator (Knuth).
    struct Noise(u64);

    impl Noise {
        fn next(&mut self, amplitude: i32) -> i32 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let span = 2 * i64::from(amplitude) + 1;
            ((self.0 >> 33) as i64 % span - i64::from(amplitude)) as i32
        }
    }

    /// Words until the first slip is confirmed, for a level that changes from `before` to
    /// `after` at word 1000, with noise that scales with the level.
    fn first_slip(before: i32, after: i32, noise: i32, seed: u64) -> Option<(usize, Slip)> {
        let mut detector = SlipDetector::new();
        let mut random = Noise(seed);
        (0..3000).find_map(|k| {
            let (level, scale) = if k < 1000 {
                (before, f64::from(noise))
            } else {
                let scale = f64::from(after) / f64::from(before);
                (after, f64::from(noise) * scale.abs())
            };
            match detector.push(level + random.next(scale as i32)) {
                Verdict::Slipped(slip) => Some((k, slip)),
                _ => None,
            }
        })
    }

    /// 1 g and a zero-g error of 60 mg on the 4 g range, in 31-bit steps, noise of 6 mg.
    const LEVELS: [i32; 4] = [132_000_000, -132_000_000, 30_000_000, -60_000_000];
    const NOISE: i32 = 800_000;

    #[test]
    fn a_slip_is_seen_on_an_axis_with_offset() {
        for (seed, level) in LEVELS.into_iter().enumerate() {
            let seed = seed as u64;
            let confirmed = 1000 + CONFIRM as usize - 1;
            assert_eq!(
                first_slip(level, 2 * level, NOISE, seed),
                Some((confirmed, Slip::Doubled)),
                "level {level} seed {seed}"
            );
            assert_eq!(
                first_slip(level, level / 2, NOISE, seed),
                Some((confirmed, Slip::Halved)),
                "level {level} seed {seed}"
            );
        }
    }

    #[test]
    fn a_doubled_level_that_overflows_is_seen() {
        let level = 700_000_000;
        let mut detector = SlipDetector::new();
        let mut random = Noise(1);
        for _ in 0..1000 {
            detector.push(level + random.next(NOISE));
        }
        let shifted = |value: i32| (value << 2) >> 1;
        let verdicts = [(); CONFIRM as usize].map(|()| {
            let word = shifted(level + random.next(NOISE));
            detector.push(word)
        });
        assert_eq!(verdicts.last(), Some(&Verdict::Slipped(Slip::Doubled)));
    }

    #[test]
    fn steps_of_other_ratios_are_signals() {
        for (seed, level) in LEVELS.into_iter().enumerate() {
            for percent in [
                -200, -100, -50, 0, 20, 40, 60, 75, 120, 150, 180, 220, 300, 400,
            ] {
                let after = (i64::from(level) * percent / 100) as i32;
                let seed = seed as u64;
                assert_eq!(
                    first_slip(level, after, NOISE, seed),
                    None,
                    "level {level} to {percent} % seed {seed}"
                );
            }
        }
    }

    #[test]
    fn noise_around_zero_never_slips() {
        for seed in 0..20 {
            let mut detector = SlipDetector::new();
            let mut random = Noise(seed);
            for k in 0..100_000 {
                let verdict = detector.push(random.next(NOISE));
                assert!(
                    matches!(verdict, Verdict::Usual | Verdict::Strange),
                    "word {k} seed {seed}: {verdict:?}"
                );
            }
        }
    }

    #[test]
    fn a_signal_that_doubles_through_a_filter_is_a_signal() {
        // A step that takes four words and overshoots by 9 %, as a step behind the converter's
        // filter does.
        let level = 100_000_000;
        let mut detector = SlipDetector::new();
        for _ in 0..1000 {
            detector.push(level);
        }
        let percent = (0..200).map(|k| match k {
            0 => 95,
            1 => 120,
            2 => 180,
            3 => 209,
            4 => 195,
            5 => 206,
            _ => 200,
        });
        for (k, percent) in percent.enumerate() {
            let verdict = detector.push(level / 100 * percent);
            assert!(!matches!(verdict, Verdict::Slipped(_)), "word {k}");
        }
    }
}
