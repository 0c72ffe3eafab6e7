//! Blocks of one length, and the squared differences of the means of neighbours.

use crate::wide::Wide;

/// Fraction bits of a block's mean, which is rounded once: to 2^-21 of a count. Codes are below
/// 2^42 ([`CODE_LIMIT`]), so means stay below 2^62 and their differences below 2^63.
pub(super) const FRACTION_BITS: u32 = 20;

/// Samples of a block, or of as much of it as is there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) sum: i128,
    pub(super) samples: u64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Octave {
    /// The first half of the block under way, once complete.
    pub(super) half: Block,
    /// Mean and samples of the block before, if it counts.
    pub(super) previous: Option<(i64, u64)>,
    pub(super) squares: Wide<3>,
    pub(super) terms: u64,
    /// Sum of `1/f` of the blocks of each difference.
    pub(super) inverse_fractions: f64,
}

impl Block {
    pub(super) const EMPTY: Self = Self { sum: 0, samples: 0 };

    /// Mean of the samples there, in steps of 2^-20, if they are 90 % of `m`.
    fn mean(self, m: u64) -> Option<i64> {
        if u128::from(self.samples) * 10 < u128::from(m) * 9 {
            return None;
        }
        let samples = i128::from(self.samples);
        Some((((self.sum << FRACTION_BITS) + samples / 2).div_euclid(samples)) as i64)
    }
}

impl Octave {
    pub(super) const EMPTY: Self = Self {
        half: Block::EMPTY,
        previous: None,
        squares: Wide::ZERO,
        terms: 0,
        inverse_fractions: 0.0,
    };

    /// Accepts a complete block of `m` samples, of which those there count.
    pub(super) fn push(&mut self, m: u64, block: Block) {
        let recent = block.mean(m).map(|mean| (mean, block.samples));
        if let (Some((before, before_samples)), Some((mean, samples))) = (self.previous, recent) {
            self.squares
                .add_square(i128::from(mean) - i128::from(before));
            self.terms += 1;
            let inverse = |samples: u64| m as f64 / samples as f64;
            self.inverse_fractions += 0.5 * (inverse(before_samples) + inverse(samples));
        }
        self.previous = recent;
    }
}
