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
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slip {
    /// Twice the level: a bit was lost and a later one taken in.
    Doubled,
    /// Half the level: a bit came twice or too early.
    Halved,
}

/// What one word says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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
mod tests;
