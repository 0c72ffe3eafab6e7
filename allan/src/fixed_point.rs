//! Codes for floating-point samples, so that they can feed the integer estimators.
//!
//! Rounding every sample once to a fixed grid keeps the estimators' exactness: the result is the
//! exact variance of the rounded samples, whatever the mean, the length or the order of work. The
//! alternative, compensated floating-point sums, would need an error analysis for every
//! statistic and would give different bits for different splits of the record.
//!
//! If the grid is `resolution` and no sample is clipped, a rounded sample is off by at most
//! `resolution / 2`, so by Minkowski's inequality a deviation of any statistic here is off by at
//! most `resolution` (Allan and modified: two means of rounded samples, divided by the square
//! root of two; Hadamard: weights 1, 2, 1 over the square root of six).

use serde::{Deserialize, Serialize};

/// Magnitude limit of a code: |code| < 2^42.
///
/// At averaging times below 2^34 samples this keeps a third difference below 2^79 and the inner sum
/// of a modified one below 2^111, the widths that the streaming state holds.
pub const CODE_LIMIT: i64 = 1 << 42;

/// An affine map from `f64` samples to integer codes: `sample = offset + resolution * code`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "(f64, f64)", into = "(f64, f64)")]
pub struct FixedPoint {
    offset: f64,
    /// A power of two.
    resolution: f64,
    /// `1 / resolution`, exactly.
    inverse: f64,
}

impl FixedPoint {
    /// A grid on which every one of `samples` has a code, as fine as [`CODE_LIMIT`] allows when
    /// later samples may lie `headroom` times (at least 1) further from the first one.
    ///
    /// The resolution is a power of two, so samples that are themselves multiples of it (integers,
    /// `f32` values of similar size) are represented exactly. Non-finite samples are ignored.
    /// Samples that are all equal get a grid 2^40 finer than their own magnitude (or than 1).
    #[must_use]
    pub fn covering(samples: impl IntoIterator<Item = f64>, headroom: f64) -> Self {
        let mut finite = samples.into_iter().filter(|sample| sample.is_finite());
        let first = finite.next().unwrap_or(0.0);
        let (spread, size) = finite.fold((0.0_f64, first.abs()), |(spread, size), sample| {
            (spread.max((sample - first).abs()), size.max(sample.abs()))
        });
        // Distances may overflow where the samples themselves do not.
        let (offset, spread) = if spread.is_finite() {
            (first, spread)
        } else {
            (0.0, size)
        };
        let reach = if spread > 0.0 {
            spread * headroom.max(1.0)
        } else if offset == 0.0 {
            1.0
        } else {
            offset.abs()
        };
        // reach < 2^exponent, so every code is below 2^41 and rounding cannot reach the limit.
        let (_, exponent) = libm::frexp(reach.min(f64::MAX));
        let exponent = (exponent - 41).max(-1022);
        Self {
            offset,
            resolution: libm::ldexp(1.0, exponent),
            inverse: libm::ldexp(1.0, -exponent),
        }
    }

    /// The size of one code in the samples' unit.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.resolution
    }

    /// The nearest code, or `None` if the sample is not finite or lies outside the grid.
    #[must_use]
    #[inline]
    pub fn code(&self, sample: f64) -> Option<i64> {
        let (code, fits) = self.round(sample);
        fits.then_some(code)
    }

    /// The nearest code and whether there is one; without a branch, so that loops vectorise.
    #[inline(always)]
    pub(crate) fn round(&self, sample: f64) -> (i64, bool) {
        // Sums near 3 * 2^51 are whole, rounded to even like every sum, and their lowest bits are
        // those of the integer.
        const WHOLE: f64 = 6_755_399_441_055_744.0;
        let shifted = (sample - self.offset) * self.inverse + WHOLE;
        let code = (shifted.to_bits() as i64).wrapping_sub(WHOLE.to_bits() as i64);
        // Comparisons with NaN fail, as they should.
        (code, (shifted - WHOLE).abs() < CODE_LIMIT as f64)
    }

    /// Turns a variance in squared codes into one in squared units of the samples.
    #[must_use]
    pub fn scale_variance(&self, variance_codes: f64) -> f64 {
        variance_codes * self.resolution * self.resolution
    }
}

impl From<FixedPoint> for (f64, f64) {
    fn from(grid: FixedPoint) -> Self {
        (grid.offset, grid.resolution)
    }
}

impl TryFrom<(f64, f64)> for FixedPoint {
    type Error = &'static str;

    fn try_from((offset, resolution): (f64, f64)) -> Result<Self, Self::Error> {
        let inverse = resolution.recip();
        let is_power_of_two = libm::frexp(resolution).0 == 0.5;
        if offset.is_finite() && resolution.is_normal() && inverse.is_normal() && is_power_of_two {
            Ok(Self {
                offset,
                resolution,
                inverse,
            })
        } else {
            Err("a grid needs a finite offset and a power of two as resolution")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_noise_on_a_large_mean_is_exact() {
        let samples = [9.80665, 9.806_651, 9.806_649_3];
        let grid = FixedPoint::covering(samples, 4.0);
        for sample in samples {
            let code = grid.code(sample).expect("inside the grid");
            assert_eq!(9.80665 + grid.resolution() * code as f64, sample);
        }
    }

    #[test]
    fn samples_off_the_grid_have_no_code() {
        let grid = FixedPoint::covering([0.0, 1.0], 1.0);
        assert!(grid.code(1.0).is_some());
        for sample in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e3, -1e3] {
            assert_eq!(grid.code(sample), None, "{sample}");
        }
    }

    #[test]
    fn the_largest_numbers_have_codes() {
        let samples = [f64::MAX, -f64::MAX, 0.0];
        let grid = FixedPoint::covering(samples, 4.0);
        assert!(samples.iter().all(|&sample| grid.code(sample).is_some()));
    }

    #[test]
    fn constant_and_empty_input_give_a_usable_grid() {
        for samples in [&[][..], &[0.0], &[9.8, 9.8], &[f64::NAN], &[1e-300, 1e-300]] {
            let grid = FixedPoint::covering(samples.iter().copied(), 16.0);
            assert!(
                grid.resolution() > 0.0 && grid.resolution().is_normal(),
                "{samples:?}"
            );
            if let Some(&first) = samples.first().filter(|sample| sample.is_finite()) {
                assert_eq!(grid.code(first), Some(0), "{samples:?}");
            }
        }
    }
}
