//! How well a record of a given length determines the squares at best.
//!
//! The information of Whittle's likelihood over the frequencies `j / T` of a record: one degree of
//! information each, `I_ij = sum_j u_i(f_j) u_j(f_j) / S(f_j)^2`, with `u` the spectra of the terms
//! for coefficient 1 and `S` that of the model. Its inverse is the Cramér-Rao bound for unbiased
//! estimates. A signal chain cancels: it filters numerator and denominator alike.
//!
//! P. Whittle, *Estimation and information in stationary time series*, Ark. Mat. 2 (1953).

use nalgebra::DMatrix;

use super::components::SEEN;
use crate::fit::design::Design;
use crate::model::PerCoefficient;

/// Frequencies that are summed one by one; the rest in steps of one part in as many.
const SINGLE: usize = 512;

/// Information on the squares of [`SEEN`] in `duration_s` of data, at the model `squares`.
pub fn information(
    design: &Design,
    squares: &PerCoefficient<f64>,
    duration_s: f64,
) -> DMatrix<f64> {
    let highest = 0.5 * design.rate_hz() * duration_s;
    let mut sum = DMatrix::zeros(SEEN.len(), SEEN.len());
    let (mut from, mut width) = (0.5, 1.0);
    while from < highest {
        let width_here = f64::min(width, highest - from);
        let f_hz = (from + 0.5 * width_here) / duration_s;
        let parts = SEEN.map(|one| design.unit_spectrum(one, f_hz));
        let total: f64 = SEEN
            .iter()
            .zip(parts)
            .map(|(&one, part)| squares.get(one) * part)
            .sum();
        for i in 0..SEEN.len() {
            for j in 0..SEEN.len() {
                sum[(i, j)] += width_here * (parts[i] / total) * (parts[j] / total);
            }
        }
        from += width_here;
        if from > SINGLE as f64 {
            width = from / SINGLE as f64;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::information::inverse;
    use super::*;
    use crate::model::published::{DURATION_S, PublishedAxis, RATE_HZ};

    /// Relative standard deviations of K, B, N, Q in percent, from an independent computation over
    /// the published table.
    #[test]
    fn bounds_of_the_published_record() {
        let design = Design::new(RATE_HZ, None);
        for (axis, expected) in PublishedAxis::ALL.into_iter().zip([
            [5.3, 8.2, 0.57, 0.022],
            [6.1, 10.2, 0.51, 0.022],
            [5.4, 9.6, 0.55, 0.022],
        ]) {
            let truth = axis.coefficients();
            let squares = PerCoefficient::from_fn(|one| truth.get(one).powi(2));
            let covariance = inverse(&information(&design, &squares, DURATION_S));
            for (i, &one) in SEEN.iter().enumerate() {
                // Half of the square's relative deviation is the coefficient's.
                let percent = 50.0 * covariance[(i, i)].sqrt() / squares.get(one);
                assert!(
                    (percent / expected[i] - 1.0).abs() < 0.025,
                    "{axis:?} {one:?}: {percent}"
                );
            }
        }
    }
}
