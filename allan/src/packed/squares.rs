//! Squares of the two numbers of each word, added up without loss.

use super::{BIAS, BIASES, LOW_BITS};

/// Words in two parts that are summed before a partial sum is moved to a wider one: so many products
/// of parts below 2^27 stay below 2^63.
pub(super) const SOME: usize = 1 << 9;

/// Adds up what `sum` gives for the places from `from` to `to`, at most `most` at a time.
#[inline(always)]
pub(super) fn chunks(
    (from, to, most): (usize, usize, usize),
    sum: impl Fn(usize, usize) -> u128,
) -> u128 {
    let mut total = 0;
    let mut begin = from;
    while begin < to {
        let end = to.min(begin + most);
        total = sum(begin, end).wrapping_add(total);
        begin = end;
    }
    total
}

#[inline(always)]
fn halves(word: u64) -> (u64, u64) {
    (word & u64::from(u32::MAX), word >> 32)
}

/// `2 b^2` less the squares of both differences `d` of a word, as `(b + d)(b - d)` twice: the factors
/// are positive, since not every vector unit multiplies signed numbers.
#[inline(always)]
fn short_of_biases(word: u64) -> u64 {
    let (low, high) = halves(word);
    // 2 b less b + d, in both halves.
    let (low_rest, high_rest) = halves(BIASES.wrapping_mul(2).wrapping_sub(word));
    (low * low_rest).wrapping_add(high * high_rest)
}

/// Sum of the squares of both differences of each word, below 2^64.
#[inline(always)]
pub(super) fn small_pairs(words: impl Iterator<Item = u64>) -> u64 {
    let (mut count, mut short) = (0_u64, 0_u64);
    for word in words {
        count += 1;
        short = short.wrapping_add(short_of_biases(word));
    }
    // What wraps on the way does not matter.
    count.wrapping_mul(2 * BIAS * BIAS).wrapping_sub(short)
}

/// Sum of the squares of both differences of each word.
#[inline(always)]
pub(super) fn pairs(words: impl Iterator<Item = u64>) -> u128 {
    let (mut count, mut low, mut high) = (0_u64, 0_u64, 0_u64);
    for word in words {
        let short = halves(short_of_biases(word));
        count += 1;
        low += short.0;
        high += short.1;
    }
    let short = u128::from(low) + (u128::from(high) << 32);
    (u128::from(count) * u128::from(2 * BIAS * BIAS)).wrapping_sub(short)
}

/// Sum of the squares of differences `d = 2^25 h + l` in at most [`SOME`] words that hold `h + b` and
/// `l + b`: with the sums `H` and `L` of these,
///
/// ```text
/// sum of l^2 = sum of (l+b)^2 - 2 b L + n b^2            likewise for h^2
/// sum of h l = sum of (h+b)(l+b) - b (H + L) + n b^2
/// ```
#[inline(always)]
pub(super) fn parts(words: impl Iterator<Item = u64>) -> u128 {
    let (mut count, mut totals, mut high_total) = (0_u64, 0_u64, 0_u64);
    let (mut low_squares, mut products, mut high_squares) = (0_u64, 0_u64, 0_u64);
    for word in words {
        let (low, high) = halves(word);
        low_squares = low_squares.wrapping_add(low * low);
        products = products.wrapping_add(low * high);
        high_squares = high_squares.wrapping_add(high * high);
        totals = totals.wrapping_add(word);
        high_total += high;
        count += 1;
    }
    // Each of the three is known modulo 2^64 and lies within 2^63 on either side of zero.
    let low_total = totals.wrapping_sub(high_total << 32);
    let biases = count.wrapping_mul(BIAS * BIAS);
    let square = |squares: u64, total: u64| {
        let linear = total.wrapping_mul(2 * BIAS);
        u128::from(squares.wrapping_sub(linear).wrapping_add(biases))
    };
    let linear = (low_total + high_total).wrapping_mul(BIAS);
    let products = products.wrapping_sub(linear).wrapping_add(biases) as i64;
    let squares =
        square(low_squares, low_total) + (square(high_squares, high_total) << (2 * LOW_BITS));
    squares.wrapping_add_signed(i128::from(products) << (LOW_BITS + 1))
}
