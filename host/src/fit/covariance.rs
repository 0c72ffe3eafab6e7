//! Covariance of the points of one modified Allan curve, under a model of the noise.
//!
//! All points are made from the same samples, so they err together. For two estimates that
//! average squared Gaussian differences `D1` and `D2` (normalised to the variances), `n1` of them
//! at the distance of `s1` samples in the denser one,
//!
//! ```text
//! cov = 2 / n1 * sum over lags l = k s1 of r(l)^2,    r(l) = E[D1(t) D2(t + l)]
//! ```
//!
//! which by Parseval is an integral of `S^2 k1 k2` over frequency, `k` being the kernel of the
//! variance: `cov = 4 / (n1 s1 tau0) * int S^2 k1 k2 df`. Taking differences only every `s1`
//! samples changes nothing in that as long as their power lies below `fs / (2 s1)`; it does,
//! since `s1` is at most 1/24 of the averaging time and the modified kernel falls with the fourth
//! power of frequency. The formula holds for records long against both averaging times; where a
//! record is short, the point's own degrees of freedom rule.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use crate::bins::point::Point;
use crate::model::kernel::{Kernel, panels};

const KERNEL: Kernel = Kernel::Modified;

/// Oscillations of a kernel that are resolved; a percent of a covariance is enough.
const CYCLES: f64 = 4.0;

/// Panels an oscillation.
const PANELS_PER_CYCLE: f64 = 2.0;

/// Relative width of a panel where the integrand is smooth.
const RELATIVE_PANEL: f64 = 0.5;

/// Panels over the band from zero to the rate at least.
const PANELS_PER_RATE: f64 = 32.0;

/// Mean over an oscillation of sin^12 over the square of that of sin^6: what the same kernel has
/// in common with itself beyond two that oscillate apart.
const MEAN_SIN12_RATIO: f64 = 231.0 / 1024.0 / (5.0 / 16.0 * 5.0 / 16.0);

/// The covariance matrix of the variances of `points`, ascending in `m`, if the samples have the
/// two-sided spectral density `spectrum` and the points the expected variances `expected`.
pub fn covariance(
    points: &[Point],
    rate_hz: f64,
    spectrum: impl Fn(f64) -> f64,
    expected: &DVector<f64>,
) -> DMatrix<f64> {
    let n = points.len();
    let mut matrix = DMatrix::zeros(n, n);
    for (i, first) in points.iter().enumerate() {
        for (j, second) in points.iter().enumerate().skip(i) {
            let span_s = first.terms as f64 * first.stride as f64 / rate_hz;
            matrix[(i, j)] = 4.0 / span_s * overlap(first.m, second.m, rate_hz, &spectrum);
        }
    }
    // The finite record, which the integral does not know.
    let stretch = DVector::from_fn(n, |i, _| {
        let short = 2.0 * expected[i].powi(2) / points[i].edf;
        (short / matrix[(i, i)]).max(1.0).sqrt()
    });
    matrix.fill_lower_triangle_with_upper_triangle();
    DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] * stretch[i] * stretch[j])
}

/// Integral of `S^2 k1 k2` from zero to half the rate, for `m1 <= m2`.
fn overlap(m1: u64, m2: u64, rate_hz: f64, spectrum: &impl Fn(f64) -> f64) -> f64 {
    let x = |f: f64| PI * f / rate_hz;
    let nyquist = 0.5 * rate_hz;
    let (cycle1, cycle2) = (rate_hz / m1 as f64, rate_hz / m2 as f64);
    let both_hz = (CYCLES * cycle2).min(nyquist);
    let first_hz = (CYCLES * cycle1).min(nyquist);
    let widest = rate_hz / PANELS_PER_RATE;
    let smooth = |f: f64| (RELATIVE_PANEL * f).min(widest);
    let both = panels(
        0.0,
        both_hz,
        |_| (cycle2 / PANELS_PER_CYCLE).min(widest),
        |f| spectrum(f).powi(2) * KERNEL.at(m1, x(f)) * KERNEL.at(m2, x(f)),
    );
    let first = panels(
        both_hz,
        first_hz,
        |f| smooth(f).min(cycle1 / PANELS_PER_CYCLE),
        |f| spectrum(f).powi(2) * KERNEL.at(m1, x(f)) * KERNEL.mean(m2, x(f)),
    );
    let common = if m1 == m2 { MEAN_SIN12_RATIO } else { 1.0 };
    let neither = panels(first_hz, nyquist, smooth, |f| {
        spectrum(f).powi(2) * KERNEL.mean(m1, x(f)) * KERNEL.mean(m2, x(f))
    });
    both + first + common * neither
}

#[cfg(test)]
mod tests {
    use inm_allan::Statistic;
    use inm_allan::edf::{Noise, edf};

    use super::*;
    use crate::model::Coefficient;

    #[test]
    fn variances_agree_with_exact_degrees_of_freedom() {
        // A record long against all averaging times, where both must say the same.
        for (coefficient, noise) in [
            (Coefficient::Q, Noise::Quantisation),
            (Coefficient::N, Noise::White),
            (Coefficient::K, Noise::Walk),
        ] {
            let term = coefficient.term(1.0);
            for m in [1, 2, 5, 40, 3000] {
                let stride = (m / 24).max(1);
                let terms = 4000 * m / stride;
                let exact = edf(Statistic::Modified, noise, m, stride, terms);
                let expected =
                    crate::model::kernel::variance(KERNEL, m, 1.0, |f| term.spectrum(f, 1.0));
                let span = (terms * stride) as f64;
                let variance = 4.0 / span * overlap(m, m, 1.0, &|f| term.spectrum(f, 1.0));
                let ratio = 2.0 * expected.powi(2) / variance / exact;
                assert!((ratio - 1.0).abs() < 0.02, "{noise:?} m={m}: {ratio}");
            }
        }
    }
}
