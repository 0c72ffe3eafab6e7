//! Covariance of the points of one Allan curve, under a model of the noise.
//!
//! All points are made from the same samples, so they err together. For two estimates that
//! average squared Gaussian differences `D1` and `D2` (normalised to the variances) at distances
//! `s1 <= s2`,
//!
//! ```text
//! cov = 2 / n1 * sum over lags l = k s1 of r(l)^2,    r(l) = E[D1(t) D2(t + l)]
//! ```
//!
//! with `n1` differences of the first. By Parseval that is an integral of `S^2 k1 k2` over
//! frequency, `k` being the Allan kernel, up to half the rate `fs / s1` at which the first is
//! taken. Power above that (differenced noise, mostly) folds back as noise of its own, with
//! the correlation of second differences of a white sequence, whose sums are known. The formula
//! holds for records long against both averaging times; where a record is short, the caller's
//! own degrees of freedom rule.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use super::design::Design;
use crate::bins::point::Point;
use crate::model::kernel::{kernel, panels};
use crate::model::{Coefficient, PerCoefficient};

/// Oscillations of a kernel that are resolved; a few percent of a covariance is enough.
const CYCLES: f64 = 4.0;

/// Means over an oscillation of sin^4 and of sin^8.
const MEAN_SIN4: f64 = 3.0 / 8.0;
const MEAN_SIN8: f64 = 35.0 / 128.0;

/// Sums over lags of products of the correlations of second differences of a white sequence,
/// (1, -2, 1) with itself: at the same spacing 70/36, at different ones 36/36.
const FOLDED_SAME: f64 = 70.0 / 36.0;
const FOLDED_OTHER: f64 = 1.0;

/// The covariance matrix of the variances of `points`, ascending in `m`, if the squared
/// coefficients are `squares`.
pub fn covariance(
    points: &[Point],
    rate_hz: f64,
    design: &Design,
    squares: &PerCoefficient<f64>,
) -> DMatrix<f64> {
    let spectrum = |f: f64| design.spectrum(squares, f);
    let parts: Vec<Part> = points
        .iter()
        .map(|point| Part::new(point, rate_hz, &spectrum))
        .collect();
    let n = points.len();
    let mut matrix = DMatrix::zeros(n, n);
    for i in 0..n {
        let model: f64 = Coefficient::ALL
            .into_iter()
            .map(|one| squares.get(one) * design.unit_allan_variance(one, points[i].m))
            .sum();
        for j in i..n {
            matrix[(i, j)] = parts[i].covariance(&parts[j], rate_hz, &spectrum);
        }
        // The finite record, which the integral does not know.
        let short = 2.0 * model * model / points[i].edf.max(f64::MIN_POSITIVE);
        let scale = (short / matrix[(i, i)]).max(1.0).sqrt();
        let scale = if scale.is_finite() { scale } else { 1.0 };
        for k in 0..=i {
            matrix[(k, i)] *= scale;
        }
        for k in i..n {
            matrix[(i, k)] *= scale;
        }
    }
    matrix.fill_lower_triangle_with_upper_triangle();
    matrix
}

/// What a point needs for its covariance with later ones.
struct Part {
    m: u64,
    terms: f64,
    /// Half the rate at which its differences are taken, hertz.
    edge_hz: f64,
    stride: f64,
    /// Variance from frequencies below the edge, and from above.
    below: f64,
    above_density: f64,
    /// Integral of `S^2 / sin^4` from the last resolved oscillation to the edge.
    tail: f64,
    resolved_hz: f64,
}

impl Part {
    fn new(point: &Point, rate_hz: f64, spectrum: &impl Fn(f64) -> f64) -> Self {
        let edge_hz = 0.5 * rate_hz / point.stride as f64;
        let resolved_hz = (CYCLES * rate_hz / point.m as f64).min(edge_hz);
        let cycle = rate_hz / point.m as f64;
        let wide = |f: f64| (0.5 * f).min(rate_hz / 32.0).max(0.25 * cycle);
        let sine2 = |f: f64| (PI * f / rate_hz).sin().powi(2);
        let above_density = panels(edge_hz, 0.5 * rate_hz, wide, |f| spectrum(f) / sine2(f));
        let below = 2.0
            * (panels(
                0.0,
                resolved_hz,
                |_| 0.5 * cycle,
                |f| spectrum(f) * kernel(point.m, PI * f / rate_hz),
            ) + panels(resolved_hz, edge_hz, wide, |f| {
                spectrum(f) * mean_kernel(point.m, f, rate_hz)
            }));
        let tail = panels(resolved_hz, edge_hz, wide, |f| {
            (spectrum(f) / sine2(f)).powi(2)
        });
        Self {
            m: point.m,
            terms: point.terms as f64,
            edge_hz,
            stride: point.stride as f64,
            below,
            above_density,
            tail,
            resolved_hz,
        }
    }

    /// Variance at `m` from frequencies above this point's edge.
    fn above(&self, m: u64) -> f64 {
        4.0 * MEAN_SIN4 * self.above_density / (m as f64).powi(2)
    }

    /// Covariance with a point at the same or a longer averaging time.
    fn covariance(&self, other: &Self, rate_hz: f64, spectrum: &impl Fn(f64) -> f64) -> f64 {
        let same = self.m == other.m;
        let cycle = rate_hz / other.m as f64;
        let both_hz = (CYCLES * cycle).min(self.edge_hz).min(self.resolved_hz);
        let wide = |f: f64| (0.5 * f).min(0.25 * rate_hz / self.m as f64);
        let x = |f: f64| PI * f / rate_hz;
        let both = panels(
            0.0,
            both_hz,
            |_| 0.5 * cycle,
            |f| spectrum(f).powi(2) * kernel(self.m, x(f)) * kernel(other.m, x(f)),
        );
        let first = panels(both_hz, self.resolved_hz, wide, |f| {
            spectrum(f).powi(2) * kernel(self.m, x(f)) * mean_kernel(other.m, f, rate_hz)
        });
        let mean = if same {
            MEAN_SIN8
        } else {
            MEAN_SIN4 * MEAN_SIN4
        };
        let tail = 4.0 * mean * self.tail / (self.m as f64 * other.m as f64).powi(2);
        let below = 2.0 * (both + first + tail) * rate_hz / self.stride;
        let (above1, above2) = (self.above(self.m), self.above(other.m));
        let folded = if same { FOLDED_SAME } else { FOLDED_OTHER };
        // Products of folded and other parts, as for white noise: 5/3 of the lag-zero product.
        let mixed = if same {
            10.0 / 3.0 * self.below * above1
        } else {
            (self.below * above1 * other.below * above2).sqrt()
        };
        2.0 / self.terms * (below + folded * above1 * above2 + mixed)
    }
}

fn mean_kernel(m: u64, f_hz: f64, rate_hz: f64) -> f64 {
    2.0 * MEAN_SIN4 / (m as f64 * (PI * f_hz / rate_hz).sin()).powi(2)
}
