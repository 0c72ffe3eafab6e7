//! The squared coefficients at which the likelihood is greatest, by Fisher scoring under `>= 0`.
//!
//! With `E_b = sum_i c_i E_ib` the log-likelihood is `-1/2 sum_b dof_b (ln E_b + y_b / E_b)`.
//! One step of Fisher scoring is a least-squares fit of the bins weighted by `dof_b / 2 E_b^2` at
//! the present expectation (Nelder and Wedderburn 1972), solved under `c_i >= 0`; steps that
//! overshoot are halved. Components are scaled to the data first, so units do not matter.

use nalgebra::{DMatrix, DVector};

use super::data::Data;
use super::{information, non_negative};
use crate::numeric::mixture::add_mixture;

/// Most steps; a dozen are usual.
const STEPS: usize = 200;

/// Most halvings of a step.
const HALVINGS: usize = 40;

/// Gain in log-likelihood below which the search has arrived.
const ARRIVED: f64 = 1e-10;

/// Bins on either side that the first guess of a bin's expectation averages.
const NEIGHBOURS: usize = 4;

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

struct Search<'a> {
    data: &'a Data,
    fixed: &'a [f64],
    /// Each component over what it may reach at most, so that unknowns are of order one.
    components: Vec<Vec<f64>>,
    scale: Vec<f64>,
    range: Range,
}

impl<'a> Search<'a> {
    fn new(data: &'a Data, components: &[Vec<f64>], fixed: &'a [f64], range: Range) -> Self {
        let level = smooth(data);
        let scale: Vec<f64> = components
            .iter()
            .map(|component| {
                let reach = component.iter().zip(&level);
                let most = reach.map(|(one, y)| one / y).fold(0.0, f64::max);
                if most > 0.0 { most } else { 1.0 }
            })
            .collect();
        let components = components
            .iter()
            .zip(&scale)
            .map(|(component, scale)| component.iter().map(|one| one / scale).collect())
            .collect();
        Self {
            data,
            fixed,
            components,
            scale,
            range,
        }
    }

    /// The best scaled squares and their log-likelihood.
    fn best(&self, start: Option<&[f64]>) -> Option<(DVector<f64>, f64)> {
        if let Some(start) = start {
            return self.run(self.scaled(start));
        }
        // The likelihood is not concave: two starts far apart, the better end.
        let guess = self.step(&smooth(self.data));
        let even = DVector::from_element(self.components.len(), 1.0);
        [guess, even]
            .into_iter()
            .filter_map(|start| self.run(start))
            .max_by(|one, other| one.1.total_cmp(&other.1))
    }

    fn scaled(&self, squared: &[f64]) -> DVector<f64> {
        DVector::from_fn(self.scale.len(), |i, _| squared[i] * self.scale[i])
    }

    fn expected(&self, x: &DVector<f64>) -> Vec<f64> {
        let mut expected = self.fixed.to_vec();
        add_mixture(&mut expected, &self.components, x.as_slice());
        expected
    }

    /// Weighted least squares with the weights of `expected`.
    fn step(&self, expected: &[f64]) -> DVector<f64> {
        let size = self.components.len();
        let (mut gram, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        // Relative to the expectation, so that nothing over- or underflows.
        let relative: Vec<Vec<f64>> = self
            .components
            .iter()
            .map(|component| component.iter().zip(expected).map(|(u, e)| u / e).collect())
            .collect();
        let weights = &self.data.dof;
        for i in 0..size {
            for j in i..size {
                let pairs = relative[i].iter().zip(&relative[j]).zip(weights);
                gram[(i, j)] = pairs.map(|((a, b), w)| w * a * b).sum::<f64>();
                gram[(j, i)] = gram[(i, j)];
            }
            right[i] = (0..expected.len())
                .map(|b| {
                    let rest = (self.data.psd[b] - self.fixed[b]) / expected[b];
                    weights[b] * relative[i][b] * rest
                })
                .sum();
        }
        match self.range {
            Range::NonNegative => non_negative::solve(&gram, &right),
            Range::Any => non_negative::solve_any(&gram, &right),
        }
    }

    fn run(&self, start: DVector<f64>) -> Option<(DVector<f64>, f64)> {
        let mut x = start;
        let mut expected = self.expected(&x);
        let mut value = log_likelihood(self.data, &expected);
        if value == f64::NEG_INFINITY {
            // Some bins are left to the components that were put at zero.
            x.iter_mut().for_each(|x| *x = x.max(1e-3));
            expected = self.expected(&x);
            value = log_likelihood(self.data, &expected);
        }
        if !value.is_finite() {
            return None;
        }
        for _ in 0..STEPS {
            let direction = self.step(&expected) - &x;
            let mut share = 1.0;
            let mut better = None;
            for _ in 0..HALVINGS {
                let candidate = &x + share * &direction;
                let expected = self.expected(&candidate);
                let value_there = log_likelihood(self.data, &expected);
                if value_there > value {
                    better = Some((candidate, expected, value_there));
                    break;
                }
                share *= 0.5;
            }
            let Some((candidate, expected_there, value_there)) = better else {
                break;
            };
            let gain = value_there - value;
            (x, expected, value) = (candidate, expected_there, value_there);
            if gain < ARRIVED {
                break;
            }
        }
        Some((x, value))
    }
}

/// Densities averaged over neighbours, weighted by their degrees of freedom; positive.
fn smooth(data: &Data) -> Vec<f64> {
    let size = data.len();
    (0..size)
        .map(|b| {
            let near = b.saturating_sub(NEIGHBOURS)..(b + NEIGHBOURS + 1).min(size);
            let dof: f64 = data.dof[near.clone()].iter().sum();
            let sum: f64 = near.map(|b| data.dof[b] * data.psd[b]).sum();
            (sum / dof).max(1e-6 * data.unit)
        })
        .collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
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
