//! Sums of squared differences over a row of neighbouring knots, as fast as exactness allows.
//!
//! A row holds cumulative sums modulo 2^64. The caller knows a bound on the differences and the
//! kernels choose the cheapest arithmetic that is exact below it:
//!
//! - up to 2^28: differences modulo 2^32, squares of 32-bit numbers;
//! - up to 2^51: 64-bit differences, squared in two halves of 26 bits;
//! - up to 2^58: 64-bit differences, squared to 128 bits.
//!
//! They are plain loops that the compiler vectorises; [`with_vectors`] lets it use what the
//! processor has.

/// Runs `work` with the widest vector instructions found at run time.
#[inline]
pub(crate) fn with_vectors<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    return pulp::Arch::new().dispatch(work);
    #[cfg(not(all(feature = "simd", target_arch = "x86_64")))]
    work()
}

/// Squares summed before a partial sum is moved to a wider one: 2^8 of 2^56 fit 64 bits.
pub(crate) const CHUNK: usize = 256;
/// Largest magnitude whose square is taken in 32-bit arithmetic.
pub(crate) const NARROW: u64 = 1 << 28;
/// Largest magnitude at all: 2^11 squares of 2^116 fit 128 bits.
pub(crate) const WIDEST: u64 = 1 << 58;
/// Magnitudes below this are squared in two halves.
const SPLIT: u64 = 1 << 51;
const HALF_BITS: u32 = 26;
const HALF_MASK: u64 = (1 << HALF_BITS) - 1;

/// A row of cumulative sums modulo 2^64, and the same modulo 2^32.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    words: &'a [i64],
    halves: &'a [i32],
}

impl<'a> Row<'a> {
    /// Of `words`, with room for their halves.
    #[inline(always)]
    pub(crate) fn new(words: &'a [i64], halves: &'a mut [i32]) -> Self {
        let halves = &mut halves[..words.len()];
        for (half, &word) in halves.iter_mut().zip(words) {
            *half = word as i32;
        }
        Self { words, halves }
    }
}

/// Sum of the squares of `v[i] - 2 v[i-lag] + v[i-2 lag]` for `i` from `from` (at least `2 lag`) to
/// the end, at most 2^11 of them of magnitude at most `bound`, itself at most [`WIDEST`].
#[inline(always)]
pub(crate) fn second_differences(row: Row<'_>, lag: usize, from: usize, bound: u64) -> u128 {
    if bound <= NARROW {
        chunks(
            row.halves.len(),
            from,
            #[inline(always)]
            |from, to| {
                let part = |lags: usize| &row.halves[from - lags * lag..to - lags * lag];
                let knots = part(2).iter().zip(part(1)).zip(part(0));
                narrow(knots.map(|((old, middle), new)| {
                    new.wrapping_sub(*middle)
                        .wrapping_sub(middle.wrapping_sub(*old))
                }))
            },
        )
    } else {
        chunks(
            row.words.len(),
            from,
            #[inline(always)]
            |from, to| {
                let part = |lags: usize| &row.words[from - lags * lag..to - lags * lag];
                let knots = part(2).iter().zip(part(1)).zip(part(0));
                wider(
                    bound,
                    knots.map(|((old, middle), new)| {
                        new.wrapping_sub(*middle)
                            .wrapping_sub(middle.wrapping_sub(*old))
                    }),
                )
            },
        )
    }
}

/// Sum of the squares of `v[i] - 3 v[i-lag] + 3 v[i-2 lag] - v[i-3 lag]`, likewise.
#[inline(always)]
pub(crate) fn third_differences(row: Row<'_>, lag: usize, from: usize, bound: u64) -> u128 {
    if bound <= NARROW {
        chunks(
            row.halves.len(),
            from,
            #[inline(always)]
            |from, to| {
                let part = |lags: usize| &row.halves[from - lags * lag..to - lags * lag];
                let knots = part(3).iter().zip(part(2)).zip(part(1)).zip(part(0));
                narrow(knots.map(|(((oldest, old), middle), new)| {
                    let inner = middle.wrapping_sub(*old);
                    new.wrapping_sub(*oldest)
                        .wrapping_sub(inner.wrapping_mul(3))
                }))
            },
        )
    } else {
        chunks(
            row.words.len(),
            from,
            #[inline(always)]
            |from, to| {
                let part = |lags: usize| &row.words[from - lags * lag..to - lags * lag];
                let knots = part(3).iter().zip(part(2)).zip(part(1)).zip(part(0));
                wider(
                    bound,
                    knots.map(|(((oldest, old), middle), new)| {
                        let inner = middle.wrapping_sub(*old);
                        let thrice = inner.wrapping_add(inner).wrapping_add(inner);
                        new.wrapping_sub(*oldest).wrapping_sub(thrice)
                    }),
                )
            },
        )
    }
}

/// Squares of at most [`CHUNK`] numbers of magnitude up to `bound`, itself at most [`WIDEST`].
#[inline(always)]
pub(crate) fn squares(bound: u64, differences: impl Iterator<Item = i64>) -> u128 {
    if bound <= NARROW {
        narrow(differences.map(|difference| difference as i32))
    } else {
        wider(bound, differences)
    }
}

/// Adds up what `sum` gives for chunks of the indices from `from` to `len`.
#[inline(always)]
fn chunks(len: usize, from: usize, sum: impl Fn(usize, usize) -> u128) -> u128 {
    let mut total = 0;
    let mut begin = from;
    while begin < len {
        let end = len.min(begin + CHUNK);
        total += sum(begin, end);
        begin = end;
    }
    total
}

/// Squares of at most [`CHUNK`] numbers of magnitude up to [`NARROW`].
#[inline(always)]
fn narrow(differences: impl Iterator<Item = i32>) -> u128 {
    // Of magnitudes, since SSE2 multiplies unsigned numbers only.
    let square = |d: i32| u64::from(d.unsigned_abs()) * u64::from(d.unsigned_abs());
    u128::from(differences.fold(0_u64, |sum, d| sum + square(d)))
}

/// Squares of at most [`CHUNK`] numbers of magnitude up to `bound`.
#[inline(always)]
fn wider(bound: u64, differences: impl Iterator<Item = i64>) -> u128 {
    if bound < SPLIT {
        split(differences)
    } else {
        full(differences)
    }
}

/// Squares of numbers below [`SPLIT`].
///
/// With `u = d + 2^51 = a 2^26 + b`, halves below 2^26, the sum of `d^2` is that of
/// `a^2 2^52 + a b 2^27 + b^2 - u 2^52 + 2^102`. Each partial sum stays below 2^60, and unsigned
/// halves need one multiplication instruction where signed ones would need three.
#[inline(always)]
fn split(differences: impl Iterator<Item = i64>) -> u128 {
    let mut count = 0_u64;
    let (mut total, mut high, mut cross, mut low) = (0_u64, 0_u64, 0_u64, 0_u64);
    for difference in differences {
        let biased = difference.wrapping_add(SPLIT as i64) as u64;
        let (a, b) = ((biased >> HALF_BITS) & HALF_MASK, biased & HALF_MASK);
        total = total.wrapping_add(biased);
        high = high.wrapping_add(a * a);
        cross = cross.wrapping_add(a * b);
        low = low.wrapping_add(b * b);
        count += 1;
    }
    let squares = (u128::from(high) << 52) + (u128::from(cross) << 27) + u128::from(low);
    // The exact total is not negative, so it does not matter that a partial one may wrap.
    squares
        .wrapping_sub(u128::from(total) << 52)
        .wrapping_add(u128::from(count) << 102)
}

/// Squares of numbers of magnitude up to [`WIDEST`].
#[inline(always)]
fn full(differences: impl Iterator<Item = i64>) -> u128 {
    differences.fold(0_u128, |sum, difference| {
        let magnitude = u128::from(difference.unsigned_abs());
        sum + magnitude * magnitude
    })
}
