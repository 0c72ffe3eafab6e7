//! Sums of squared differences over a row of neighbouring knots, two numbers to a word.
//!
//! A word `w = p + 2^32 q` modulo 2^64 carries two numbers. A linear combination of words with small
//! integer coefficients is the same combination of the `p` plus 2^32 times that of the `q`,
//! whatever borrows from whatever meanwhile; and where both results, raised by [`BIAS`], lie in
//! [0, 2^32), they are the halves of the raised word. So one subtraction serves two numbers, and a
//! multiplication of 32-bit halves, which every vector unit has, squares them.
//!
//! The caller knows a bound on the differences and gets the cheapest arithmetic that is exact below
//! it:
//!
//! - up to [`PAIRED`]: a word is two knots, half a row apart; up to [`SMALL`] the squares are added
//!   up without a thought;
//! - up to [`SPLIT`]: a word is one knot, its low 25 bits and the rest;
//! - up to [`WIDEST`]: plain 64-bit differences, squared to 128 bits.
//!
//! Only a damaged state has differences beyond their bound; its sums wrap then.

mod order;
mod squares;

use core::marker::PhantomData;

use crate::grid::LONGEST;
use crate::kernels::{CHUNK, WIDEST, squares};
use squares::{SOME, chunks, pairs, parts, small_pairs};

pub(crate) use order::{Order, Second, Third};

/// Added to both halves of a word of differences, whose magnitude it exceeds.
const BIAS: u64 = 1 << 31;
const BIASES: u64 = BIAS << 32 | BIAS;

/// Largest magnitude of a difference of which a word holds two.
const PAIRED: u64 = BIAS - 1;

/// Largest magnitude of differences of which 2^11 squares stay below 2^64.
const SMALL: u64 = 1 << 26;

/// Bits of the lower of two parts of a knot: third differences of it are below 2^27.
const LOW_BITS: u32 = 25;
const LOW_MASK: u64 = (1 << LOW_BITS) - 1;

/// Largest magnitude of a difference that is taken in two parts, the upper one of 2^26 and a borrow.
const SPLIT: u64 = 1 << 51;

/// Working space: the words of a row.
pub(crate) struct Packed {
    words: [u64; LONGEST],
    multiples: [u64; LONGEST],
}

/// What a word holds.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Content {
    Pairs,
    Parts,
}

/// A row of cumulative sums modulo 2^64, of which differences of order `O` are wanted.
pub(crate) struct Differences<'a, O> {
    row: &'a [i64],
    /// Position of the first knot at which a new difference ends.
    fresh: usize,
    packed: &'a mut Packed,
    held: Option<Content>,
    order: PhantomData<O>,
}

impl Packed {
    pub(crate) const EMPTY: Self = Self {
        words: [0; LONGEST],
        multiples: [0; LONGEST],
    };
}

impl<'a, O: Order> Differences<'a, O> {
    /// Of `row`, at most 2^11 of them, that end at `fresh` or later.
    #[inline(always)]
    pub(crate) fn new(row: &'a [i64], fresh: usize, packed: &'a mut Packed) -> Self {
        Self {
            row,
            fresh,
            packed,
            held: None,
            order: PhantomData,
        }
    }

    /// Number and sum of the squares of all differences at `lag`, of magnitude at most `bound`,
    /// itself at most [`WIDEST`]. `None` where the row has no room for one.
    #[inline(always)]
    pub(crate) fn squares(&mut self, lag: usize, bound: u64) -> Option<(u64, u128)> {
        debug_assert!(bound <= WIDEST, "differences of up to {bound}");
        let (from, to) = (self.fresh.max(O::LAGS * lag), self.row.len());
        if from >= to {
            return None;
        }
        let sum = if bound <= PAIRED {
            let half = self.hold_pairs();
            // The lower halves of the words end here, the upper ones at the end of the row. Between
            // them is left: of an odd number the last, and where the row has no room for the
            // first fresh differences, as many.
            let paired = to - half;
            let pairs = if from >= paired {
                0
            } else if bound <= SMALL {
                u128::from(small_pairs(O::raised(self.packed, lag, from, paired)))
            } else {
                pairs(O::raised(self.packed, lag, from, paired))
            };
            let (from, to) = (from.max(paired), to.min(from + half));
            pairs.wrapping_add(squares(bound, O::plain(self.row, lag, from, to)))
        } else if bound <= SPLIT {
            self.hold_parts();
            chunks(
                (from, to, SOME),
                #[inline(always)]
                |from, to| parts(O::raised(self.packed, lag, from, to)),
            )
        } else {
            chunks(
                (from, to, CHUNK),
                #[inline(always)]
                |from, to| squares(bound, O::plain(self.row, lag, from, to)),
            )
        };
        Some(((to - from) as u64, sum))
    }

    /// Puts two knots into each word; returns how far they are apart.
    #[inline(always)]
    fn hold_pairs(&mut self) -> usize {
        let half = (self.row.len() - self.fresh).div_ceil(2);
        if self.held != Some(Content::Pairs) {
            let knots = self.row.iter().zip(&self.row[half..]);
            for (word, (&low, &high)) in self.packed.words.iter_mut().zip(knots) {
                *word = (low as u64).wrapping_add((high as u64) << 32);
            }
            self.multiply(self.row.len() - half);
            self.held = Some(Content::Pairs);
        }
        half
    }

    /// Puts the two parts of a knot into each word.
    #[inline(always)]
    fn hold_parts(&mut self) {
        if self.held != Some(Content::Parts) {
            for (word, &knot) in self.packed.words.iter_mut().zip(self.row) {
                let (low, high) = (knot as u64 & LOW_MASK, knot as u64 >> LOW_BITS);
                *word = low | high << 32;
            }
            self.multiply(self.row.len());
            self.held = Some(Content::Parts);
        }
    }

    #[inline(always)]
    fn multiply(&mut self, len: usize) {
        let words = &self.packed.words[..len];
        for (multiple, &word) in self.packed.multiples.iter_mut().zip(words) {
            *multiple = O::multiple(word);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row in which every difference is as large as its neighbours' distance allows.
    fn swinging(size: i64, fresh: usize) -> [i64; LONGEST] {
        core::array::from_fn(|i| [0, size][(i + fresh) % 2])
    }

    #[test]
    fn a_whole_row_at_each_limit() {
        let mut packed = Packed::EMPTY;
        for limit in [SMALL, PAIRED + 1, SPLIT, WIDEST / 2].map(|limit| limit as i64) {
            // A second difference is two swings, a third one four.
            for size in [limit / 2 - 1, limit / 2, limit / 2 + 1] {
                let row = swinging(size, 121);
                let bound = 2 * size.unsigned_abs();
                let second = Differences::<Second>::new(&row, 121, &mut packed).squares(1, bound);
                let expected = u128::from(bound) * u128::from(bound) * 2048;
                assert_eq!(second, Some((2048, expected)), "second, up to {bound}");
            }
            for size in [limit / 4 - 1, limit / 4, limit / 4 + 1] {
                let row = swinging(size, 121);
                let bound = 4 * size.unsigned_abs();
                let third = Differences::<Third>::new(&row, 121, &mut packed).squares(1, bound);
                let expected = u128::from(bound) * u128::from(bound) * 2048;
                assert_eq!(third, Some((2048, expected)), "third, up to {bound}");
            }
        }
    }

    /// As in a damaged state: any result, no panic.
    #[test]
    fn differences_beyond_their_bound_wrap() {
        let mut packed = Packed::EMPTY;
        let row: [i64; LONGEST] = core::array::from_fn(|i| [i64::MIN, i64::MAX, 7][i % 3]);
        for bound in [SMALL, PAIRED, SPLIT, WIDEST] {
            let second = Differences::<Second>::new(&row, 121, &mut packed).squares(1, bound);
            let third = Differences::<Third>::new(&row, 121, &mut packed).squares(2, bound);
            assert_eq!(second.map(|(terms, _)| terms), Some(2048));
            assert_eq!(third.map(|(terms, _)| terms), Some(2048));
        }
    }

    #[test]
    fn rows_too_short_for_their_fresh_differences() {
        let mut packed = Packed::EMPTY;
        let row: [i64; 200] = core::array::from_fn(|i| (i as i64 * 7919) % 1000);
        for (len, fresh, lag) in [(200, 1, 40), (200, 1, 66), (131, 121, 3), (100, 30, 40)] {
            let row = &row[..len];
            let mut differences =
                |bound| Differences::<Third>::new(row, fresh, &mut packed).squares(lag, bound);
            let expected = differences(WIDEST);
            assert_eq!(
                differences(8000),
                expected,
                "small pairs: {len} {fresh} {lag}"
            );
            assert_eq!(differences(PAIRED), expected, "pairs: {len} {fresh} {lag}");
            assert_eq!(differences(SPLIT), expected, "parts: {len} {fresh} {lag}");
        }
        let none = Differences::<Second>::new(&row[..80], 1, &mut packed).squares(40, 8000);
        assert_eq!(none, None);
    }
}
