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
use crate::model::kernel::{Kernel, nodes};

const KERNEL: Kernel = Kernel::Modified;

/// Oscillations of a kernel that are resolved; a percent of a covariance is enough.
const CYCLES: f64 = 4.0;

/// Panels an oscillation.
const PANELS_PER_CYCLE: f64 = 2.0;

/// Panels over the band from zero to the rate at least.
const PANELS_PER_RATE: f64 = 32.0;

/// Mean over an oscillation of sin^12 over the square of that of sin^6: what the same kernel has
/// in common with itself beyond two that oscillate apart.
const MEAN_SIN12_RATIO: f64 = 231.0 / 1024.0 / (5.0 / 16.0 * 5.0 / 16.0);

/// The kernels of all points at the frequencies over which all covariances are integrated.
///
/// A kernel that oscillates `CYCLES` times below a frequency is resolved by panels of a fixed part
/// of that frequency, whatever its `m`, so one set of frequencies serves them all.
pub struct Kernels {
    rate_hz: f64,
    points: Vec<Point>,
    /// Frequencies, hertz, and their weights in the integral.
    nodes: Vec<(f64, f64)>,
    /// A row for each point, a column for each frequency; beyond the oscillations that are resolved
    /// the mean over them.
    values: DMatrix<f64>,
}

impl Kernels {
    /// For the points of a curve at `rate_hz`, ascending in `m`.
    pub fn new(points: &[Point], rate_hz: f64) -> Self {
        let longest = points.iter().map(|point| point.m).max().unwrap_or(1);
        let narrowest = rate_hz / longest as f64 / PANELS_PER_CYCLE;
        let widest = rate_hz / PANELS_PER_RATE;
        let width = |f: f64| (f / CYCLES / PANELS_PER_CYCLE).max(narrowest).min(widest);
        let nodes: Vec<(f64, f64)> = nodes(0.0, 0.5 * rate_hz, width).collect();
        let values = DMatrix::from_fn(points.len(), nodes.len(), |row, column| {
            let (m, f) = (points[row].m, nodes[column].0);
            let x = PI * f / rate_hz;
            if f < resolved_hz(m, rate_hz) {
                KERNEL.at(m, x)
            } else {
                KERNEL.mean(m, x)
            }
        });
        Self {
            rate_hz,
            points: points.to_vec(),
            nodes,
            values,
        }
    }

    /// The covariance matrix of the variances of the points, if the samples have the two-sided
    /// spectral density `spectrum` and the points the expected variances `expected`.
    pub fn covariance(
        &self,
        spectrum: impl Fn(f64) -> f64,
        expected: &DVector<f64>,
    ) -> DMatrix<f64> {
        let matrix = self.integrals(spectrum);
        let n = self.points.len();
        let long = DMatrix::from_fn(n, n, |i, j| {
            let denser = &self.points[i.min(j)];
            let span_s = denser.terms as f64 * denser.stride as f64 / self.rate_hz;
            4.0 / span_s * matrix[(i, j)]
        });
        // The finite record, which the integral does not know.
        let stretch = DVector::from_fn(n, |i, _| {
            let short = 2.0 * expected[i].powi(2) / self.points[i].edf;
            (short / long[(i, i)]).max(1.0).sqrt()
        });
        DMatrix::from_fn(n, n, |i, j| long[(i, j)] * stretch[i] * stretch[j])
    }

    /// Integrals of `S^2 k1 k2` from zero to half the rate, for each two points.
    fn integrals(&self, spectrum: impl Fn(f64) -> f64) -> DMatrix<f64> {
        let weigh = |&(f, weight): &(f64, f64)| weight * spectrum(f).powi(2);
        let weights: Vec<f64> = self.nodes.iter().map(weigh).collect();
        let mut weighted = self.values.clone();
        for (mut column, weight) in weighted.column_iter_mut().zip(&weights) {
            column *= *weight;
        }
        let mut matrix = &weighted * self.values.transpose();
        for (i, point) in self.points.iter().enumerate() {
            let resolved_hz = resolved_hz(point.m, self.rate_hz);
            // Frequencies ascend.
            let beyond = self.nodes.partition_point(|&(f, _)| f < resolved_hz);
            let row = (weighted.row(i), self.values.row(i));
            let mean = row
                .0
                .columns_range(beyond..)
                .dot(&row.1.columns_range(beyond..));
            matrix[(i, i)] += (MEAN_SIN12_RATIO - 1.0) * mean;
        }
        matrix
    }
}

/// Frequency up to which the oscillations of the kernel for `m` are resolved.
fn resolved_hz(m: u64, rate_hz: f64) -> f64 {
    CYCLES * rate_hz / m as f64
}

#[cfg(test)]
mod tests {
    use inm_allan::Statistic;
    use inm_allan::edf::{Noise, edf};

    use super::*;
    use crate::model::Coefficient;

    fn point(m: u64) -> Point {
        Point {
            m,
            tau_s: m as f64,
            variance: 1.0,
            terms: 1,
            stride: 1,
            edf: 1.0,
            lo: 0.0,
            hi: 0.0,
            bridged: false,
            white_bias: 1.0,
        }
    }

    #[test]
    fn shared_frequencies_serve_any_two_points() {
        let factors = [1, 4, 5, 40, 700];
        let kernels = Kernels::new(&factors.map(point), 1.0);
        for coefficient in [
            Coefficient::Q,
            Coefficient::N,
            Coefficient::B,
            Coefficient::K,
        ] {
            let term = coefficient.term(1.0);
            let spectrum = |f: f64| term.spectrum(f, 1.0);
            let found = kernels.integrals(spectrum);
            for (i, &m1) in factors.iter().enumerate() {
                for (j, &m2) in factors.iter().enumerate() {
                    // Every oscillation resolved, all the way up.
                    let product = |f: f64| KERNEL.at(m1, PI * f) * KERNEL.at(m2, PI * f);
                    let fine = |_| 0.2 / m1.max(m2) as f64;
                    let exact: f64 = nodes(0.0, 0.5, fine)
                        .map(|(f, weight)| weight * spectrum(f).powi(2) * product(f))
                        .sum();
                    let ratio = found[(i, j)] / exact;
                    assert!(
                        (ratio - 1.0).abs() < 0.01,
                        "{coefficient:?} {m1} {m2}: {ratio}"
                    );
                }
            }
        }
    }

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
                let kernels = Kernels::new(&[point(m)], 1.0);
                let variance = 4.0 / span * kernels.integrals(|f| term.spectrum(f, 1.0))[(0, 0)];
                let ratio = 2.0 * expected.powi(2) / variance / exact;
                assert!((ratio - 1.0).abs() < 0.02, "{noise:?} m={m}: {ratio}");
            }
        }
    }
}
