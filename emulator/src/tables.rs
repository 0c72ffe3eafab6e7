//! The coefficients of the converter's decimating FIR stages, in both phase responses.
//!
//! The only home of these tables in the project. FIR1, FIR2 and b0..b14 of the others are printed
//! in the data sheets of the family (ADS1283, ADS1285, ADS1287: the same table); FIR3 and FIR4
//! linear in full in public seismometer response files that cite the ADS1281. The minimum-phase
//! tails (from b15) are reproduced from memory of the sheet; the whole chain meets the published
//! ripple and stop band (see the tests of [`crate::response`]), which a single value off by more
//! than about ten counts would not. So: right as a model, not proven bit-exact against silicon.

mod minimum_phase;

pub use minimum_phase::{FIR3_MINIMUM, FIR4_MINIMUM};

/// Impulse response of FIR3 and FIR4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Phase {
    /// Symmetric, group delay 31 conversions (PHS = 0, the reset value).
    #[default]
    Linear,
    /// About 5 conversions of delay at DC (PHS = 1).
    Minimum,
}

/// Length of FIR1.
pub const FIR1_TAPS: usize = 11;
/// Length of FIR2.
pub const FIR2_TAPS: usize = 15;
/// Length of FIR3.
pub const FIR3_TAPS: usize = 51;
/// Length of FIR4.
pub const FIR4_TAPS: usize = 109;

/// FIR1, half-band, decimates by 2; unit gain is 2^[`FIR1_SHIFT`].
pub const FIR1: [i32; FIR1_TAPS] = mirrored(&[3, 0, -25, 0, 150, 256]);
/// FIR1's unit gain as a power of two.
pub const FIR1_SHIFT: u32 = 9;

/// FIR2, half-band, decimates by 2; unit gain is 2^[`FIR2_SHIFT`].
pub const FIR2: [i32; FIR2_TAPS] =
    mirrored(&[-10944, 0, 103_807, 0, -507_903, 0, 2_512_192, 4_194_304]);
/// FIR2's unit gain as a power of two.
pub const FIR2_SHIFT: u32 = 23;

/// FIR3, linear phase, decimates by 4; unit gain is 2^[`FIR3_SHIFT`] (the sum is 0.02 % less).
pub const FIR3_LINEAR: [i32; FIR3_TAPS] = mirrored(&[
    0, 0, -73, -874, -4648, -16147, -41280, -80934, -120_064, -118_690, -18203, 224_751, 580_196,
    893_263, 891_396, 293_598, -987_253, -2_635_779, -3_860_322, -3_572_512, -822_573, 4_669_054,
    12_153_698, 19_911_100, 25_779_390, 27_966_862,
]);
/// FIR3's unit gain as a power of two.
pub const FIR3_SHIFT: u32 = 27;

/// FIR4, linear phase, decimates by 2; unit gain is 2^[`FIR4_SHIFT`] (the sum is 0.02 % more).
pub const FIR4_LINEAR: [i32; FIR4_TAPS] = mirrored(&[
    -132,
    -432,
    -75,
    2481,
    6692,
    7419,
    -266,
    -10663,
    -8280,
    10620,
    22008,
    348,
    -34123,
    -25549,
    33460,
    61387,
    -7546,
    -94192,
    -50629,
    101_135,
    134_826,
    -56626,
    -220_104,
    -56082,
    263_758,
    231_231,
    -215_231,
    -430_178,
    34715,
    580_424,
    283_878,
    -588_382,
    -693_209,
    366_118,
    1_084_786,
    132_893,
    -1_300_087,
    -878_642,
    1_162_189,
    1_741_565,
    -522_533,
    -2_490_395,
    -688_945,
    2_811_738,
    2_425_494,
    -2_338_095,
    -4_511_116,
    641_555,
    6_661_730,
    2_950_811,
    -8_538_057,
    -10_537_298,
    9_818_477,
    41_426_374,
    56_835_776,
]);
/// FIR4's unit gain as a power of two.
pub const FIR4_SHIFT: u32 = 27;

/// The symmetric filter of `N` taps whose first half and centre are `half`.
const fn mirrored<const N: usize>(half: &[i32]) -> [i32; N] {
    assert!(half.len() == N / 2 + 1, "half a filter with its centre");
    let mut taps = [0; N];
    let mut i = 0;
    while i < half.len() {
        taps[i] = half[i];
        taps[N - 1 - i] = half[i];
        i += 1;
    }
    taps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(taps: &[i32]) -> i64 {
        taps.iter().map(|&tap| i64::from(tap)).sum()
    }

    #[test]
    fn sums_are_the_published_gains() {
        assert_eq!(sum(&FIR1), 1 << FIR1_SHIFT);
        assert_eq!(sum(&FIR2), 1 << FIR2_SHIFT);
        assert_eq!(sum(&FIR3_LINEAR), 134_201_050);
        assert_eq!(sum(&FIR4_LINEAR), 134_238_266);
    }

    #[test]
    fn half_band_stages_have_their_zeros() {
        for (i, (&a, &b)) in FIR1.iter().zip(FIR1.iter().rev()).enumerate() {
            assert_eq!(a, b);
            assert!(i % 2 == 0 || i == FIR1_TAPS / 2 || a == 0);
        }
        for (i, (&a, &b)) in FIR2.iter().zip(FIR2.iter().rev()).enumerate() {
            assert_eq!(a, b);
            assert!(i % 2 == 0 || i == FIR2_TAPS / 2 || a == 0);
        }
    }
}
