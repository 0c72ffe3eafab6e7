//! Sums of squares of integers, as fast as exactness allows.
//!
//! The caller knows a bound on the numbers and gets the cheapest arithmetic that is exact below it:
//!
//! - below 2^28: squares of 32-bit numbers;
//! - below 2^51: squares in two halves of 26 bits;
//! - up to 2^58: squares of 128 bits.
//!
//! Only a damaged state has numbers beyond their bound; its sums wrap then.
//!
//! They are plain loops that the compiler vectorises; [`with_vectors`] lets it use what the
//! processor has. Differences over a row of knots have loops of their own
//! ([`packed`](crate::packed)).

/// Runs `work` with the widest vector instructions found at run time.
#[inline]
pub(crate) fn with_vectors<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    return pulp::Arch::new().dispatch(work);
    #[cfg(not(all(feature = "simd", target_arch = "x86_64")))]
    work()
}

/// Squares summed before a partial sum is moved to a wider one: 2^8 of less than 2^56 fit 64 bits.
pub(crate) const CHUNK: usize = 256;
/// Magnitudes below this are squared in 32-bit arithmetic.
pub(crate) const NARROW: u64 = 1 << 28;
/// Largest magnitude at all: 2^11 squares of 2^116 fit 128 bits.
pub(crate) const WIDEST: u64 = 1 << 58;
/// Magnitudes below this are squared in two halves.
const SPLIT: u64 = 1 << 51;
const HALF_BITS: u32 = 26;
const HALF_MASK: u64 = (1 << HALF_BITS) - 1;

/// Squares of at most [`CHUNK`] numbers of magnitude up to `bound`, itself at most [`WIDEST`].
#[inline(always)]
pub(crate) fn squares(bound: u64, differences: impl Iterator<Item = i64>) -> u128 {
    if bound < NARROW {
        narrow(differences.map(|difference| difference as i32))
    } else {
        wider(bound, differences)
    }
}

/// Squares of at most [`CHUNK`] numbers of magnitude below [`NARROW`].
#[inline(always)]
fn narrow(differences: impl Iterator<Item = i32>) -> u128 {
    // Of magnitudes, since SSE2 multiplies unsigned numbers only.
    let square = |d: i32| u64::from(d.unsigned_abs()) * u64::from(d.unsigned_abs());
    u128::from(differences.fold(0_u64, |sum, d| sum.wrapping_add(square(d))))
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
        sum.wrapping_add(magnitude * magnitude)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_chunk_at_each_limit() {
        for bound in [NARROW - 1, NARROW, SPLIT - 1, SPLIT, WIDEST] {
            let magnitude = bound as i64;
            let numbers = (0..CHUNK).map(|i| [magnitude, -magnitude][i % 2]);
            let expected = u128::from(bound) * u128::from(bound) * CHUNK as u128;
            assert_eq!(squares(bound, numbers), expected, "up to {bound}");
        }
    }
}
