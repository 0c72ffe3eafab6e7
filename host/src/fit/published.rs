//! The published fit, as printed: Pavlov and Petrov eq. 9 to 11.
//!
//! Unweighted least squares of `sigma^2` on `[tau^2, tau, 1, 1/tau, 1/tau^2]` at 17 averaging
//! times, with `C1 = R^2/2`, `C2 = K^2/3`, `C3 = (2 ln2/pi) B^2`, `C4 = N^2` and `C5 = 3 Q^2`.
//! Which 17 is not said there; here: spaced evenly on the logarithmic axis from one sample to
//! the record's length over 2.5, rounded, each once.
//!
//! On noise-free curves the fit is exact. On measured ones it is ruled by the longest averaging
//! times, whose sampling error is largest, and squares come out negative; they are reported as
//! they are. The weighted fit does the same with weights.

use nalgebra::{DMatrix, DVector};

use super::least_squares;
use crate::model::{Coefficient, PerCoefficient};

/// Averaging times of the published fit.
pub const POINTS: usize = 17;

/// The longest averaging time is the record's length over this.
const LENGTH_OVER_LONGEST: f64 = 2.5;

/// The averaging factors for a record of `samples` samples.
pub fn factors(samples: u64) -> Vec<u64> {
    let longest = (samples as f64 / LENGTH_OVER_LONGEST).max(1.0).ln();
    let one = |k: usize| (longest * k as f64 / (POINTS - 1) as f64).exp().round() as u64;
    let mut factors: Vec<u64> = (0..POINTS).map(one).collect();
    factors.dedup();
    factors
}

/// Squares of the coefficients, negative where the fit says so, from points of averaging time
/// in seconds and Allan variance.
///
/// `None` where fewer than five points are given or they do not distinguish the terms.
pub fn fit(points: &[(f64, f64)]) -> Option<PerCoefficient<f64>> {
    if points.len() < Coefficient::ALL.len() {
        return None;
    }
    // Units of tau and sigma^2 in which all is near one, so that nothing under- or overflows,
    // and the largest rows first, as the solver wants them.
    let mut points = points.to_vec();
    points.sort_by(|a, b| b.1.total_cmp(&a.1));
    let basis = |row: usize, column: usize| {
        Coefficient::ALL[column]
            .term(1.0)
            .allan_asymptote(points[row].0)
    };
    let a = DMatrix::from_fn(points.len(), Coefficient::ALL.len(), basis);
    let y = DVector::from_iterator(points.len(), points.iter().map(|point| point.1));
    let squares = least_squares::solve(&a, &y)?;
    let mut squares = squares.iter();
    Some(PerCoefficient::from_fn(|_| *squares.next().unwrap_or(&0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::published::{DURATION_S, PublishedAxis, RATE_HZ};

    #[test]
    fn seventeen_factors() {
        let factors = factors(10_800_000);
        assert_eq!((factors.len(), factors[0], factors[16]), (17, 1, 4_320_000));
        assert_eq!(super::factors(10), [1, 2, 3, 4]);
    }

    #[test]
    fn exact_on_the_noise_free_curve() {
        for axis in PublishedAxis::ALL {
            let truth = axis.coefficients();
            let terms = truth.terms();
            let curve: Vec<_> = factors((DURATION_S * RATE_HZ) as u64)
                .into_iter()
                .map(|m| m as f64 / RATE_HZ)
                .map(|tau_s| {
                    (
                        tau_s,
                        terms.iter().map(|term| term.allan_asymptote(tau_s)).sum(),
                    )
                })
                .collect();
            let fitted = fit(&curve).expect("17 points");
            for coefficient in Coefficient::ALL {
                let relative = fitted.get(coefficient) / truth.get(coefficient).powi(2) - 1.0;
                assert!(
                    relative.abs() < 1e-6,
                    "{axis:?} {coefficient:?}: {relative:e}"
                );
            }
        }
    }
}
