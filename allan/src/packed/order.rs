//! Which differences are squared: second or third ones, by their weights.

use super::{BIASES, Packed};

/// Which differences are squared.
pub(crate) trait Order {
    /// Lags that one spans.
    const LAGS: usize;

    /// What [`Packed::multiples`] are of a word.
    fn multiple(word: u64) -> u64;

    /// The words' differences, raised by [`BIASES`], that end from `from` to `to`.
    fn raised(packed: &Packed, lag: usize, from: usize, to: usize) -> impl Iterator<Item = u64>;

    /// The differences themselves.
    fn plain(row: &[i64], lag: usize, from: usize, to: usize) -> impl Iterator<Item = i64>;
}

/// `v[i] - 2 v[i-lag] + v[i-2 lag]`
pub(crate) struct Second;

/// `v[i] - 3 v[i-lag] + 3 v[i-2 lag] - v[i-3 lag]`
pub(crate) struct Third;

impl Order for Second {
    const LAGS: usize = 2;

    #[inline(always)]
    fn multiple(word: u64) -> u64 {
        word.wrapping_add(word).wrapping_sub(BIASES)
    }

    #[inline(always)]
    fn raised(packed: &Packed, lag: usize, from: usize, to: usize) -> impl Iterator<Item = u64> {
        let words = |lags: usize| &packed.words[from - lags * lag..to - lags * lag];
        let twice = &packed.multiples[from - lag..to - lag];
        let knots = words(2).iter().zip(twice).zip(words(0));
        knots.map(|((old, twice), new)| new.wrapping_add(*old).wrapping_sub(*twice))
    }

    #[inline(always)]
    fn plain(row: &[i64], lag: usize, from: usize, to: usize) -> impl Iterator<Item = i64> {
        let part = |lags: usize| &row[from - lags * lag..to - lags * lag];
        let knots = part(2).iter().zip(part(1)).zip(part(0));
        knots.map(|((old, middle), new)| {
            let before = middle.wrapping_sub(*old);
            new.wrapping_sub(*middle).wrapping_sub(before)
        })
    }
}

impl Order for Third {
    const LAGS: usize = 3;

    #[inline(always)]
    fn multiple(word: u64) -> u64 {
        word.wrapping_add(word).wrapping_add(word)
    }

    #[inline(always)]
    fn raised(packed: &Packed, lag: usize, from: usize, to: usize) -> impl Iterator<Item = u64> {
        let words = |lags: usize| &packed.words[from - lags * lag..to - lags * lag];
        let thrice = |lags: usize| &packed.multiples[from - lags * lag..to - lags * lag];
        let knots = words(3).iter().zip(thrice(2)).zip(thrice(1)).zip(words(0));
        knots.map(|(((oldest, old), middle), new)| {
            let outer = new.wrapping_sub(*oldest).wrapping_add(BIASES);
            outer.wrapping_sub(middle.wrapping_sub(*old))
        })
    }

    #[inline(always)]
    fn plain(row: &[i64], lag: usize, from: usize, to: usize) -> impl Iterator<Item = i64> {
        let part = |lags: usize| &row[from - lags * lag..to - lags * lag];
        let knots = part(3).iter().zip(part(2)).zip(part(1)).zip(part(0));
        knots.map(|(((oldest, old), middle), new)| {
            let inner = middle.wrapping_sub(*old);
            let thrice = inner.wrapping_add(inner).wrapping_add(inner);
            new.wrapping_sub(*oldest).wrapping_sub(thrice)
        })
    }
}
