//! The squared coefficients at which the likelihood is greatest, by Fisher scoring under `>= 0`.
//!
//! With `E_b = sum_i c_i E_ib` the log-likelihood is `-1/2 sum_b dof_b (ln E_b + y_b / E_b)`.
//! One step of Fisher scoring is a least-squares fit of the bins weighted by `dof_b / 2 E_b^2` at
//! the present expectation (Nelder and Wedderburn 1972), solved under `c_i >= 0`; steps that
//! overshoot are halved. Components are scaled to the data first, so units do not matter.

mod search;

use nalgebra::DMatrix;

use super::data::Data;
use super::information;
use search::Search;

/// What squares may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Range {
    /// Not negative, as squares are.
    NonNegative,
    /// Any number that leaves every bin a positive expectation: for the law of estimates that a
    /// bound would cut off.
    Any,
}

/// The best fit of a set of components.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Squared coefficient of each component, not negative.
    pub squared: Vec<f64>,
    /// Expectation of every bin.
    pub expected: Vec<f64>,
    /// Log-likelihood there, as [`log_likelihood`].
    pub log_likelihood: f64,
    /// Fisher information of the squares if bins were independent.
    pub information: DMatrix<f64>,
    /// Covariance of the squares with the bins' correlation, as if none were at its bound; zero
    /// for components that do not show in any bin.
    pub covariance: DMatrix<f64>,
}

/// Log-likelihood of `expected`, in nats; only differences have a meaning. Minus infinity where an
/// expectation is not a positive number.
pub fn log_likelihood(data: &Data, expected: &[f64]) -> f64 {
    let bins = data.psd.iter().zip(&data.dof).zip(expected);
    let sum: f64 = bins
        .map(|((psd, dof), expected)| {
            if *expected > 0.0 && expected.is_finite() {
                dof * ((expected / data.unit).ln() + psd / expected)
            } else {
                f64::INFINITY
            }
        })
        .sum();
    -0.5 * sum
}

/// Finds the squared coefficients of `components`, each given as the expectations of all bins for
/// a squared coefficient of 1.
///
/// `None` where no choice of coefficients gives every bin a positive expectation.
pub fn maximise(data: &Data, components: &[Vec<f64>]) -> Option<Fit> {
    maximise_beside(data, components, &vec![0.0; data.len()], None)
}

/// As [`maximise`], together with a part `fixed` of the expectation; searches from the squares `start`
/// alone, where they are given.
pub fn maximise_beside(
    data: &Data,
    components: &[Vec<f64>],
    fixed: &[f64],
    start: Option<&[f64]>,
) -> Option<Fit> {
    let search = Search::new(data, components, fixed, Range::NonNegative);
    let (x, log_likelihood) = search.best(start)?;
    let squared: Vec<f64> = x.iter().zip(&search.scale).map(|(x, s)| x / s).collect();
    let expected = search.expected(&x);
    Some(Fit {
        information: information::fisher(data, components, &expected),
        covariance: information::covariance(data, components, &expected),
        squared,
        expected,
        log_likelihood,
    })
}

/// The squares of [`maximise_beside`], in a range, with their log-likelihood alone.
pub fn greatest_beside(
    data: &Data,
    components: &[Vec<f64>],
    fixed: &[f64],
    start: Option<&[f64]>,
    range: Range,
) -> Option<(Vec<f64>, f64)> {
    let search = Search::new(data, components, fixed, range);
    let (x, log_likelihood) = search.best(start)?;
    let squared = x.iter().zip(&search.scale).map(|(x, s)| x / s).collect();
    Some((squared, log_likelihood))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use nalgebra::DVector;
    use rand_distr::{Distribution, Gamma};

    /// Independent bins at sixteen an octave with the degrees of freedom of `span_s` of data.
    pub(in super::super) fn synthetic(seed: u64, span_s: f64, truth: impl Fn(f64) -> f64) -> Data {
        let mut random = rand_pcg::Pcg64::new(u128::from(seed), 9);
        let f_hz: Vec<f64> = (0..200)
            .map(|k| 1e-3 * (f64::from(k) / 16.0).exp2())
            .collect();
        let dof: Vec<f64> = f_hz.iter().map(|f| 2.0 * span_s * f / 23.0).collect();
        let psd = f_hz
            .iter()
            .zip(&dof)
            .map(|(&f, dof)| {
                let law = Gamma::new(0.5 * dof, 2.0 / dof).expect("positive");
                truth(f) * law.sample(&mut random)
            })
            .collect();
        let variances = DVector::from_iterator(dof.len(), dof.iter().map(|dof| 2.0 / dof));
        Data::from_parts(f_hz, psd, DMatrix::from_diagonal(&variances)).expect("positive densities")
    }

    fn components(data: &Data) -> Vec<Vec<f64>> {
        [-2, -1, 0, 2]
            .map(|power| data.f_hz.iter().map(|f| f.powi(power)).collect())
            .to_vec()
    }

    #[test]
    fn the_maximum_does_not_depend_on_the_start() {
        for seed in 0..20 {
            let data = synthetic(seed, 1e5, |f| 1e-3 / (f * f) + 0.05 / f + 1.0);
            let components = components(&data);
            let best = maximise(&data, &components).expect("a fit");
            for start in [[1.0; 4], [1e-9, 1e-9, 1e3, 1e-9], [1e2, 0.0, 1e-9, 1e-2]] {
                let zeros = vec![0.0; data.len()];
                let other =
                    maximise_beside(&data, &components, &zeros, Some(&start)).expect("a fit");
                for i in 0..4 {
                    let error = (best.squared[i] - other.squared[i]).abs();
                    let sigma = best.covariance[(i, i)].sqrt();
                    assert!(
                        error < 1e-3 * sigma,
                        "seed {seed}, {start:?}: {error:e} {sigma:e}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_line_less_is_a_likelier_spectrum_whatever_lines_are_left() {
        // Lines of ten thousand times the noise, as one bin has them, at places and heights that are drawn. Without one of them the
        // expectation that was best before is likelier, so the best one is no less likely.
        for seed in 0..40_u32 {
            let drawn = |number: u32| 2.0_f64.sqrt() * f64::from(number * (seed + 3)) % 1.0;
            let lines: Vec<usize> = (1..=3)
                .map(|number| (40.0 + 150.0 * drawn(number)) as usize)
                .collect();
            let height = 10.0_f64.powf(3.0 + 2.0 * drawn(7));
            let mut left = synthetic(300 + u64::from(seed), 1e5, |_| 1.0);
            let components = components(&left);
            let mut before = maximise(&left, &components).expect("a fit").log_likelihood;
            for line in lines {
                left.psd[line] += height;
                let now = maximise(&left, &components).expect("a fit").log_likelihood;
                assert!(
                    now < before,
                    "seed {seed}, lines of {height}: {now} after {before}"
                );
                before = now;
            }
        }
    }

    #[test]
    fn slopes_vanish_inside_and_fall_at_the_bound() {
        for seed in 0..50 {
            let data = synthetic(100 + seed, 3e4, |f| 1e-3 / (f * f) + 1.0);
            let components = components(&data);
            let fit = maximise(&data, &components).expect("a fit");
            for (i, component) in components.iter().enumerate() {
                let slope: f64 = (0..data.len())
                    .map(|b| {
                        let e = fit.expected[b];
                        0.5 * data.dof[b] * component[b] / e * (data.psd[b] / e - 1.0)
                    })
                    .sum();
                // In units of the slope's own scatter.
                let slope = slope / fit.information[(i, i)].sqrt();
                if fit.squared[i] > 0.0 {
                    assert!(slope.abs() < 1e-3, "seed {seed}, {i}: {slope:e}");
                } else {
                    assert!(slope < 1e-3, "seed {seed}, {i}: {slope:e}");
                }
            }
        }
    }

    #[test]
    fn units_do_not_matter() {
        let data = synthetic(7, 1e5, |f| 1e-3 / (f * f) + 0.05 / f + 1.0);
        let components = components(&data);
        let one = maximise(&data, &components).expect("a fit");
        for scale in [1e-18, 1e18] {
            let psd = data.psd.iter().map(|psd| psd * scale).collect();
            let scaled = Data::from_parts(data.f_hz.clone(), psd, data.covariance.clone())
                .expect("positive densities");
            let other = maximise(&scaled, &components).expect("a fit");
            for (one, other) in one.squared.iter().zip(&other.squared) {
                assert!(
                    (other / scale - one).abs() <= 1e-6 * one,
                    "{other:e} {one:e}"
                );
            }
        }
    }
}
