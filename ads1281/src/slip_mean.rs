//! A slipped bit where noise hides it in the single word: level and noise scale together.
//!
//! [`SlipDetector`](super::slip::SlipDetector) asks for a level of twenty times the noise. This
//! one compares means over blocks of words and works down to a few times the noise, at the
//! price of some hundred words of delay. A shifted stream doubles or halves everything, so
//! that the noise has to have changed by the same factor as the level: no step of a signal does
//! that. Noise is measured by the mean difference between neighbours, which the level does not
//! enter.

use super::slip::Slip;

/// Words in a block: 2^5.
const BLOCK: u32 = 1 << BLOCK_BITS;
const BLOCK_BITS: u32 = 5;
/// Blocks from which the reference is learned.
const LEARN: i64 = 12;
/// Blocks in a row that make a slip.
const CONFIRM: u32 = 2;
/// Blocks in a row, unlike anything expected, after which the reference is learned anew.
const RELEARN: u32 = 8;
/// Weight of a new block in the level, which drifts: 2^-3.
const FORGET_LEVEL: u32 = 3;
/// Weight of a new block in noise and scatter, which do not: 2^-5.
const FORGET_NOISE: u32 = 5;
/// Half-width of the usual in mean absolute deviations of the blocks' means: 3.2 standard
/// deviations.
const BAND: i64 = 4;

/// Mean and noise of one block.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    mean: i64,
    /// Mean absolute difference between neighbours.
    noise: i64,
}

/// Running level and noise of one axis, in blocks.
#[derive(Debug, Clone, Copy, Default)]
pub struct SlipMeanDetector {
    sum: i64,
    differences: i64,
    count: u32,
    last: i64,
    reference: Block,
    /// Mean absolute distance of the blocks' means from the reference.
    scatter: i64,
    learned: i64,
    suspect: Option<(Slip, u32)>,
    strangers: u32,
}

impl SlipMeanDetector {
    /// Forgets a suspicion and the block begun: the stream has been interrupted and realigned.
    pub fn realigned(&mut self) {
        self.suspect = None;
        self.strangers = 0;
        self.begin();
    }

    /// Takes the 31-bit value of the next good word; `Some` once a slip is certain.
    #[inline]
    pub fn push(&mut self, value: i32) -> Option<Slip> {
        let value = i64::from(value);
        if self.count > 0 {
            self.differences += (value - self.last).abs();
        }
        self.last = value;
        self.sum += value;
        self.count += 1;
        if self.count < BLOCK {
            return None;
        }
        let block = Block {
            mean: self.sum >> BLOCK_BITS,
            noise: self.differences / i64::from(BLOCK - 1),
        };
        self.begin();
        self.judge(block)
    }

    fn begin(&mut self) {
        self.sum = 0;
        self.differences = 0;
        self.count = 0;
    }

    fn judge(&mut self, block: Block) -> Option<Slip> {
        let distance = block.mean - self.reference.mean;
        if self.learned < LEARN {
            self.learned += 1;
            self.reference.mean += distance / self.learned;
            self.reference.noise += (block.noise - self.reference.noise) / self.learned;
            if self.learned > 1 {
                self.scatter += (distance.abs() - self.scatter) / (self.learned - 1);
            }
            return None;
        }
        let band = BAND * self.scatter + self.reference.mean.abs() / 32;
        if distance.abs() <= band {
            self.suspect = None;
            self.strangers = 0;
            self.reference.mean += distance >> FORGET_LEVEL;
            self.reference.noise += (block.noise - self.reference.noise) >> FORGET_NOISE;
            self.scatter += (distance.abs() - self.scatter) >> FORGET_NOISE;
            return None;
        }
        let Some(slip) = self.slip_of(block, band) else {
            self.suspect = None;
            self.strangers += 1;
            if self.strangers >= RELEARN {
                *self = Self::default();
            }
            return None;
        };
        let count = match self.suspect {
            Some((before, count)) if before == slip => count + 1,
            _ => 1,
        };
        self.suspect = Some((slip, count));
        (count >= CONFIRM).then_some(slip)
    }

    /// Which slip would have made this block of the reference.
    fn slip_of(&self, block: Block, band: i64) -> Option<Slip> {
        let Block { mean, noise } = self.reference;
        // The bands around the level, around its double and its half must not meet.
        if mean.abs() < 3 * band || noise == 0 {
            return None;
        }
        // A block's noise scatters by 13 %: from 3/2 to 8/3 is within 2.5 of that of twice.
        let louder = 2 * block.noise >= 3 * noise && 3 * block.noise <= 8 * noise;
        let quieter = 3 * block.noise <= 2 * noise && 8 * block.noise >= 3 * noise;
        if louder && (block.mean - 2 * mean).abs() <= 2 * band {
            Some(Slip::Doubled)
        } else if quieter && (block.mean - mean / 2).abs() <= band / 2 {
            Some(Slip::Halved)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of two uniform numbers of +-`half` by a linear congruential generator (Knuth).
    struct Noise(u64);

    impl Noise {
        fn next(&mut self, half: i64) -> i64 {
            let mut uniform = || {
                self.0 = self
                    .0
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (((self.0 >> 33) as i64 * (2 * half + 1)) >> 31) - half
            };
            uniform() + uniform()
        }
    }

    /// 0.15 g on the 4 g range and noise of a quarter of it: mean absolute deviation 4e6.
    const LEVEL: i64 = 20_000_000;
    const HALF: i64 = 6_000_000;

    /// First slip of 20000 words, when from word 10000 on the level is `level` and the noise
    /// `noise` percent of what they were.
    fn first_slip(seed: u64, level: i64, noise: i64) -> Option<(u32, Slip)> {
        let mut detector = SlipMeanDetector::default();
        let mut random = Noise(seed);
        (0..20_000).find_map(|k| {
            let (level, noise) = if k < 10_000 {
                (100, 100)
            } else {
                (level, noise)
            };
            let value = LEVEL * level / 100 + random.next(HALF) * noise / 100;
            detector.push(value as i32).map(|slip| (k, slip))
        })
    }

    #[test]
    fn level_and_noise_by_two_are_a_slip() {
        for seed in 0..50 {
            for (percent, expected) in [(200, Slip::Doubled), (50, Slip::Halved)] {
                let Some((word, slip)) = first_slip(seed, percent, percent) else {
                    panic!("seed {seed}: nothing seen of {percent} %");
                };
                assert_eq!(slip, expected, "seed {seed}");
                assert!((10_000..10_400).contains(&word), "seed {seed}: word {word}");
            }
        }
    }

    #[test]
    fn other_changes_are_signals() {
        for seed in 0..20 {
            for (level, noise) in [
                (100, 100),
                (200, 100),
                (50, 100),
                (100, 200),
                (100, 50),
                (150, 150),
                (300, 300),
                (25, 25),
                (-200, 200),
                (0, 200),
            ] {
                assert_eq!(
                    first_slip(seed, level, noise),
                    None,
                    "seed {seed}: level {level} %, noise {noise} %"
                );
            }
        }
    }
}
