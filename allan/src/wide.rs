//! Unsigned integers of a fixed number of 64-bit limbs, for sums of squares that must not round.
//!
//! Only what the accumulators need: add a square, add another sum, read out as `f64`.

/// An unsigned integer of `64 * LIMBS` bits, least significant limb first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Wide<const LIMBS: usize>([u64; LIMBS]);

impl<const LIMBS: usize> Wide<LIMBS> {
    pub(crate) const ZERO: Self = Self([0; LIMBS]);

    /// Adds `value` times 2^(64 * `from`).
    ///
    /// A carry out of the top limb would be an overflow; each user states the bound on its sum
    /// that excludes it, and debug builds check it.
    #[inline]
    fn add_at(&mut self, from: usize, value: u128) {
        let mut carry = value;
        for limb in &mut self.0[from..] {
            if carry == 0 {
                return;
            }
            let total = u128::from(*limb) + (carry & u128::from(u64::MAX));
            *limb = total as u64;
            carry = (carry >> 64) + (total >> 64);
        }
        debug_assert_eq!(carry, 0, "sum of squares exceeds {LIMBS} limbs");
    }

    /// Adds `value`.
    #[inline]
    pub(crate) fn add_u128(&mut self, value: u128) {
        self.add_at(0, value);
    }

    /// Adds the square of `value`.
    #[inline]
    pub(crate) fn add_square(&mut self, value: i128) {
        if let Ok(short) = i64::try_from(value) {
            let magnitude = u128::from(short.unsigned_abs());
            self.add_u128(magnitude * magnitude);
            return;
        }
        let magnitude = value.unsigned_abs();
        let (low, high) = (magnitude & u128::from(u64::MAX), magnitude >> 64);
        let cross = low * high;
        self.add_at(0, low * low);
        // Twice, because 2 * low * high may need 129 bits.
        self.add_at(1, cross);
        self.add_at(1, cross);
        self.add_at(2, high * high);
    }

    /// Adds another sum.
    pub(crate) fn add(&mut self, other: &Self) {
        for (from, &limb) in other.0.iter().enumerate() {
            self.add_at(from, u128::from(limb));
        }
    }

    /// From limbs, least significant first.
    pub(crate) fn from_limbs(limbs: [u64; LIMBS]) -> Self {
        Self(limbs)
    }

    /// The limbs, least significant first.
    pub(crate) fn limbs(&self) -> &[u64; LIMBS] {
        &self.0
    }

    /// The value, each limb rounded in once: relative error below 2^-51.
    pub(crate) fn to_f64(self) -> f64 {
        const TWO_POW_64: f64 = 18_446_744_073_709_551_616.0;
        self.0
            .iter()
            .rev()
            .fold(0.0, |acc, &limb| acc * TWO_POW_64 + limb as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_carry_into_every_limb() {
        // (2^127)^2 = 2^254, four times that is 2^256: the most negative value thrice fills
        // the two top bits of the top limb.
        let mut sum = Wide::<4>::ZERO;
        for _ in 0..3 {
            sum.add_square(i128::MIN);
        }
        assert_eq!(sum, Wide([0, 0, 0, 3 << 62]));
        // (2^64 - 1)^2 = 2^128 - 2^65 + 1, beyond the short path.
        let mut sum = Wide::<3>::ZERO;
        sum.add_square(i128::from(u64::MAX));
        assert_eq!(sum, Wide([1, u64::MAX - 1, 0]));
        sum.add_u128(u128::MAX);
        assert_eq!(sum, Wide([0, u64::MAX - 1, 1]));
    }

    #[test]
    fn reads_out_as_float() {
        assert_eq!(Wide([0, 0, 1, 0]).to_f64(), 2.0_f64.powi(128));
        assert_eq!(Wide([5]).to_f64(), 5.0);
    }
}
