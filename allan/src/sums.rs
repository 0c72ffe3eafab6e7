//! Accumulators of squared differences at one averaging time.

use crate::knot::{Knot, PairKnot, SumKnot, nearest_80, nearest_112};
use crate::statistic::{Estimate, Statistic};
use crate::wide::Wide;

/// Sums of squared differences over knots of one kind.
pub(crate) trait Sums: core::fmt::Debug + Copy + PartialEq {
    /// The knots the differences are taken between.
    type Knot: Knot;

    /// Nothing accumulated.
    const ZERO: Self;

    /// Whether third differences are wanted too.
    const THIRD: bool;

    /// Adds what second differences give: knots `2m`, `m` and 0 samples before the end.
    fn add_second(&mut self, knots: [Self::Knot; 3]);

    /// Adds what third differences give: knots `3m`, `2m`, `m` and 0 samples before the end.
    fn add_third(&mut self, knots: [Self::Knot; 4]);

    /// Adds `terms` squared differences of one statistic that sum to `squares`.
    fn add_total(&mut self, statistic: Statistic, squares: u128, terms: u64);

    /// The estimate of one statistic, if any difference has entered it.
    fn estimate(&self, statistic: Statistic, m: u64, stride: u64) -> Option<Estimate>;

    /// Takes `start` through every word of the accumulated state, in a fixed order.
    fn fold_words<T>(&self, start: T, enter: impl FnMut(T, u64) -> T) -> T;
}

/// Squared differences of one statistic and how many they were.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sum<const LIMBS: usize> {
    squares: Wide<LIMBS>,
    terms: u64,
}

impl<const LIMBS: usize> Sum<LIMBS> {
    pub(crate) const ZERO: Self = Self {
        squares: Wide::ZERO,
        terms: 0,
    };

    /// From a number of terms and the limbs of the sum of their squares.
    pub(crate) fn from_parts(terms: u64, limbs: [u64; LIMBS]) -> Self {
        Self {
            squares: Wide::from_limbs(limbs),
            terms,
        }
    }

    #[inline]
    fn add(&mut self, difference: i128) {
        self.squares.add_square(difference);
        self.terms += 1;
    }

    fn add_total(&mut self, squares: u128, terms: u64) {
        self.squares.add_u128(squares);
        self.terms += terms;
    }

    /// Adds another sum over other differences of the same statistic.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.squares.add(&other.squares);
        self.terms += other.terms;
    }

    fn estimate(&self, statistic: Statistic, m: u64, stride: u64) -> Option<Estimate> {
        (self.terms > 0).then(|| Estimate {
            m,
            variance: statistic.variance(m, self.terms, &self.squares),
            terms: self.terms,
            stride,
        })
    }

    #[inline]
    fn fold_words<T>(&self, start: T, mut enter: impl FnMut(T, u64) -> T) -> T {
        let limbs = self.squares.limbs().iter().copied();
        limbs.fold(enter(start, self.terms), enter)
    }
}

/// Allan variance alone: differences below 2^63, at most 2^64 of them, fit 192 bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AllanSums {
    allan: Sum<3>,
}

impl Sums for AllanSums {
    type Knot = SumKnot;
    const ZERO: Self = Self { allan: Sum::ZERO };
    const THIRD: bool = false;

    #[inline]
    fn add_second(&mut self, [old, middle, new]: [SumKnot; 3]) {
        let recent = new.sum_word().wrapping_sub(middle.sum_word());
        let before = middle.sum_word().wrapping_sub(old.sum_word());
        let magnitude = u128::from((recent.wrapping_sub(before) as i64).unsigned_abs());
        self.allan.squares.add_u128(magnitude * magnitude);
        self.allan.terms += 1;
    }

    fn add_third(&mut self, _knots: [SumKnot; 4]) {}

    fn add_total(&mut self, _statistic: Statistic, squares: u128, terms: u64) {
        self.allan.add_total(squares, terms);
    }

    fn estimate(&self, statistic: Statistic, m: u64, stride: u64) -> Option<Estimate> {
        match statistic {
            Statistic::Allan => self.allan.estimate(statistic, m, stride),
            Statistic::Modified | Statistic::Hadamard => None,
        }
    }

    #[inline]
    fn fold_words<T>(&self, start: T, enter: impl FnMut(T, u64) -> T) -> T {
        self.allan.fold_words(start, enter)
    }
}

/// All three statistics.
///
/// Differences are below 2^79 and inner sums below 2^111 ([`PairKnot`]), so that 2^34 and 2^34 of
/// their squares fit 192 and 256 bits; more differences than that exist only at averaging times
/// where they are smaller: the squares at `m` grow as `m^2` and `m^4`, their number falls as `1/m`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FamilySums {
    pub(crate) allan: Sum<3>,
    pub(crate) modified: Sum<4>,
    pub(crate) hadamard: Sum<3>,
}

impl FamilySums {
    /// Adds sums over other differences at the same averaging time.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.allan.merge(&other.allan);
        self.modified.merge(&other.modified);
        self.hadamard.merge(&other.hadamard);
    }
}

impl Sums for FamilySums {
    type Knot = PairKnot;
    const ZERO: Self = Self {
        allan: Sum::ZERO,
        modified: Sum::ZERO,
        hadamard: Sum::ZERO,
    };
    const THIRD: bool = true;

    #[inline]
    fn add_second(&mut self, knots: [PairKnot; 3]) {
        let [old, middle, new] = knots.map(PairKnot::sum);
        let difference = new.wrapping_sub(middle.wrapping_mul(2)).wrapping_add(old);
        self.allan.add(nearest_80(difference));
    }

    #[inline]
    fn add_third(&mut self, knots: [PairKnot; 4]) {
        self.hadamard
            .add(nearest_80(third_difference(knots.map(PairKnot::sum))));
        self.modified
            .add(nearest_112(third_difference(knots.map(PairKnot::double))));
    }

    fn add_total(&mut self, statistic: Statistic, squares: u128, terms: u64) {
        match statistic {
            Statistic::Allan => self.allan.add_total(squares, terms),
            Statistic::Modified => self.modified.add_total(squares, terms),
            Statistic::Hadamard => self.hadamard.add_total(squares, terms),
        }
    }

    fn estimate(&self, statistic: Statistic, m: u64, stride: u64) -> Option<Estimate> {
        match statistic {
            Statistic::Allan => self.allan.estimate(statistic, m, stride),
            Statistic::Modified => self.modified.estimate(statistic, m, stride),
            Statistic::Hadamard => self.hadamard.estimate(statistic, m, stride),
        }
    }

    fn fold_words<T>(&self, start: T, mut enter: impl FnMut(T, u64) -> T) -> T {
        let allan = self.allan.fold_words(start, &mut enter);
        let modified = self.modified.fold_words(allan, &mut enter);
        self.hadamard.fold_words(modified, enter)
    }
}

/// `new - 3 middle + 3 old - oldest`, wrapping.
#[inline]
fn third_difference([oldest, old, middle, new]: [u128; 4]) -> u128 {
    let inner = middle.wrapping_sub(old).wrapping_mul(3);
    new.wrapping_sub(oldest).wrapping_sub(inner)
}
