//! What is remembered about one index of the record: the sum of all samples before it and, where
//! the modified variance needs it, the sum of those sums.
//!
//! The sums wrap around. A difference of them is exact all the same as long as its own value fits,
//! since every operation is a ring homomorphism; the bounds stand at each type. Between two runs
//! of samples the sums carry on as if the missing samples were zero; differences never see it,
//! because the samples' offset cancels in them and they never reach across a gap.

/// What is remembered of the cumulative sums at one index.
pub(crate) trait Knot: core::fmt::Debug + Copy + PartialEq {
    /// The sums that are carried from sample to sample.
    type Running: Running<Knot = Self>;

    /// Before the first sample.
    const ORIGIN: Self;

    /// Whether the sum of sums is kept.
    const DOUBLES: bool;

    /// The sum modulo 2^64.
    fn sum_word(self) -> u64;

    /// The sum of sums modulo 2^64, where it is kept.
    fn double_word(self) -> u64;
}

/// Cumulative sums at the present index.
pub(crate) trait Running: core::fmt::Debug + Copy + PartialEq {
    /// What is remembered of them.
    type Knot;

    /// Before the first sample.
    const ORIGIN: Self;

    /// The sums one sample later.
    fn advance(self, code: i64) -> Self;

    /// The sums `missing` samples later when none of them was seen.
    fn coast(self, missing: u64) -> Self;

    /// The knot to remember.
    fn knot(self) -> Self::Knot;

    /// The sum and the sum of sums modulo 2^64; the latter is anything where it is not kept.
    fn words(self) -> (u64, u64);

    /// The sums `distance` samples later, given their words: exact while what was added meanwhile,
    /// beyond `distance` times the sum here, is below 2^63.
    fn later(self, distance: u64, sum_word: u64, double_word: u64) -> Self;
}

/// The sum modulo 2^64, for the Allan variance alone.
///
/// A difference at `m` is below `m * 2^32` for 32-bit codes, so it fits 63 bits while `m < 2^31`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SumKnot(u64);

impl Knot for SumKnot {
    type Running = Self;
    const ORIGIN: Self = Self(0);
    const DOUBLES: bool = false;

    #[inline]
    fn sum_word(self) -> u64 {
        self.0
    }

    fn double_word(self) -> u64 {
        0
    }
}

impl Running for SumKnot {
    type Knot = Self;
    const ORIGIN: Self = Self(0);

    #[inline]
    fn advance(self, code: i64) -> Self {
        Self(self.0.wrapping_add_signed(code))
    }

    fn coast(self, _missing: u64) -> Self {
        self
    }

    #[inline]
    fn knot(self) -> Self {
        self
    }

    #[inline]
    fn words(self) -> (u64, u64) {
        (self.0, 0)
    }

    #[inline]
    fn later(self, _distance: u64, sum_word: u64, _double_word: u64) -> Self {
        Self(sum_word)
    }
}

/// The sum modulo 2^80 and the sum of sums modulo 2^112, packed into three words.
///
/// At averaging factor `m` and codes of range `r` (2^32 for 32-bit codes, 2^43 for
/// [`fixed_point`](crate::fixed_point) ones) a Hadamard difference is below `2 m r` and the inner
/// sum of a modified one below `m^2 r`. Both fit for `m < 2^39` with 32-bit codes and for
/// `m < 2^34` with fixed-point ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PairKnot {
    sum_low: u64,
    double_low: u64,
    /// Upper 48 bits of the double sum, then upper 16 bits of the sum.
    high: u64,
}

const DOUBLE_HIGH_BITS: u32 = 48;

impl PairKnot {
    /// From sums of which only the low 80 and 112 bits are kept.
    #[inline]
    pub(crate) fn new(sum: u128, double: u128) -> Self {
        let double_high = (double >> 64) as u64 & ((1 << DOUBLE_HIGH_BITS) - 1);
        let sum_high = (sum >> 64) as u64;
        Self {
            sum_low: sum as u64,
            double_low: double as u64,
            high: double_high | sum_high << DOUBLE_HIGH_BITS,
        }
    }

    /// The sum modulo 2^80, in the low bits.
    #[inline]
    pub(crate) fn sum(self) -> u128 {
        u128::from(self.sum_low) | u128::from(self.high >> DOUBLE_HIGH_BITS) << 64
    }

    /// The three words it is packed into.
    pub(crate) fn to_words(self) -> [u64; 3] {
        [self.sum_low, self.double_low, self.high]
    }

    /// From the words of another knot.
    pub(crate) fn from_words([sum_low, double_low, high]: [u64; 3]) -> Self {
        Self {
            sum_low,
            double_low,
            high,
        }
    }

    /// The double sum modulo 2^112 in the low bits; what stands above is to be ignored.
    #[inline]
    pub(crate) fn double(self) -> u128 {
        u128::from(self.double_low) | u128::from(self.high) << 64
    }
}

impl PairKnot {
    /// This knot of a record that began at zero `distance` samples ago, as a knot of the record
    /// that had reached `base` there.
    pub(crate) fn continuing(self, base: PairSums, distance: u64) -> Self {
        base.continued(
            PairSums {
                sum: self.sum(),
                double: self.double(),
            },
            distance,
        )
        .knot()
    }
}

impl Knot for PairKnot {
    type Running = PairSums;
    const ORIGIN: Self = Self {
        sum_low: 0,
        double_low: 0,
        high: 0,
    };
    const DOUBLES: bool = true;

    #[inline]
    fn sum_word(self) -> u64 {
        self.sum_low
    }

    #[inline]
    fn double_word(self) -> u64 {
        self.double_low
    }
}

/// The sum and the sum of sums modulo 2^128.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PairSums {
    pub(crate) sum: u128,
    pub(crate) double: u128,
}

impl PairSums {
    /// Where a record continues that began at zero `distance` samples after these sums and has
    /// reached `later` of its own.
    pub(crate) fn continued(self, later: Self, distance: u64) -> Self {
        let double = self.coast(distance).double.wrapping_add(later.double);
        Self {
            sum: self.sum.wrapping_add(later.sum),
            double,
        }
    }
}

impl Running for PairSums {
    type Knot = PairKnot;
    const ORIGIN: Self = Self { sum: 0, double: 0 };

    #[inline]
    fn advance(self, code: i64) -> Self {
        Self {
            sum: self.sum.wrapping_add_signed(i128::from(code)),
            double: self.double.wrapping_add(self.sum),
        }
    }

    fn coast(self, missing: u64) -> Self {
        let passed = self.sum.wrapping_mul(u128::from(missing));
        Self {
            double: self.double.wrapping_add(passed),
            ..self
        }
    }

    #[inline]
    fn knot(self) -> PairKnot {
        PairKnot::new(self.sum, self.double)
    }

    #[inline]
    fn words(self) -> (u64, u64) {
        (self.sum as u64, self.double as u64)
    }

    #[inline]
    fn later(self, distance: u64, sum_word: u64, double_word: u64) -> Self {
        let follow = |from: u128, word: u64| {
            from.wrapping_add_signed(i128::from(word.wrapping_sub(from as u64) as i64))
        };
        Self {
            sum: follow(self.sum, sum_word),
            double: follow(self.coast(distance).double, double_word),
        }
    }
}

/// A value known modulo 2^80, as the number nearest to zero.
#[inline]
pub(crate) fn nearest_80(value: u128) -> i128 {
    (value << 48) as i128 >> 48
}

/// A value known modulo 2^112, as the number nearest to zero.
#[inline]
pub(crate) fn nearest_112(value: u128) -> i128 {
    (value << 16) as i128 >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packs_and_wraps() {
        let knot = PairKnot::new(u128::MAX, u128::MAX);
        assert_eq!(nearest_80(knot.sum()), -1);
        assert_eq!(nearest_112(knot.double()), -1);
        let knot = PairSums::ORIGIN.advance(-5).advance(7).advance(1).knot();
        // S = 0, -5, 2, 3; W = 0, 0, -5, -3.
        assert_eq!(
            (nearest_80(knot.sum()), nearest_112(knot.double())),
            (3, -3)
        );
    }

    #[test]
    fn coasting_is_advancing_by_zeros() {
        let start = PairSums::ORIGIN.advance(i64::from(i32::MIN)).advance(3);
        let stepped = (0..9).fold(start, |sums, _| sums.advance(0));
        assert_eq!(start.coast(9), stepped);
    }

    #[test]
    fn continuing_joins_two_records() {
        let codes = [i64::from(i32::MAX), -7, 1 << 45, -(1 << 45), 3, 3];
        let run = |codes: &[i64], from: PairSums| codes.iter().fold(from, |s, &c| s.advance(c));
        let base = run(&codes[..2], PairSums::ORIGIN);
        let part = run(&codes[2..], PairSums::ORIGIN);
        assert_eq!(base.continued(part, 4), run(&codes, PairSums::ORIGIN));
    }
}
