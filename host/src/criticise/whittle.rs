//! The working likelihood of the diagnosis: log-spaced bins of a spectrum against a sum of laws.
//!
//! Each bin is the mean of `nu / 2` ordinates, so it follows a gamma law about its expectation
//! `E_b`; up to a constant
//!
//! ```text
//! ln L = -kappa sum_b (nu_b / 2) (ln E_b + P_b / E_b)
//! ```
//!
//! (P. Whittle 1953), with `kappa` the share of the information on a common factor that is left
//! when neighbouring bins vary together. The squared coefficients enter linearly and are not
//! negative; they are found by Fisher scoring.

use nalgebra::{DMatrix, DVector};

use crate::chain::Chain;
use crate::fit::design::Design;
use crate::model::{Coefficient, PerCoefficient};
use crate::spectrum::estimate::{self, Estimate};
use crate::spectrum::{Cascade, Plan, Settings};

/// Rounds of scoring, at most.
const ROUNDS: usize = 60;

/// Gain in log-likelihood below which scoring has arrived.
const ARRIVED: f64 = 1e-7;

/// The coefficients that show in a spectrum.
pub const RANDOM: [Coefficient; 4] = [
    Coefficient::K,
    Coefficient::B,
    Coefficient::N,
    Coefficient::Q,
];

/// What the spectra of one axis have in common: bins, and what they are expected to be.
pub struct Frame {
    settings: Settings,
    estimate: Estimate,
    design: Design,
    /// Expectations of the bins for each of [`RANDOM`] at coefficient 1.
    units: Vec<Vec<f64>>,
    /// Power of the signal chain at the nodes.
    chain_power: Vec<f64>,
    kappa: f64,
    rate_hz: f64,
    plan: Plan,
}

/// A fitted sum of laws.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Squared coefficients, one for each component.
    pub squared: Vec<f64>,
    /// Expectations of the bins.
    pub expected: Vec<f64>,
    /// Log-likelihood, nats.
    pub log_likelihood: f64,
}

impl Frame {
    /// For records like `values`, with missing samples where these are not finite.
    pub fn new(values: &[f64], rate_hz: f64, chain: Option<&Chain>, bins_per_octave: f64) -> Self {
        let settings = Settings {
            bins_per_octave,
            ..Settings::default()
        };
        let plan = Plan::new();
        let mut cascade = Cascade::new(&plan);
        cascade
            .push_values(0, values)
            .expect("the first block is in order");
        let estimate = Estimate::new(&cascade, rate_hz, &settings);
        let design = Design::new(rate_hz, chain);
        let nodes = estimate.operator.nodes_hz();
        let chain_power: Vec<f64> = nodes
            .iter()
            .map(|&f_hz| chain.map_or(1.0, |chain| chain.power(f_hz, rate_hz)))
            .collect();
        let units = RANDOM
            .iter()
            .map(|&one| {
                let densities: Vec<f64> = nodes
                    .iter()
                    .zip(&chain_power)
                    .map(|(&f_hz, power)| design.unit_spectrum(one, f_hz) * power)
                    .collect();
                estimate.operator.apply(&densities)
            })
            .collect();
        let kappa = kappa(&estimate);
        Self {
            settings,
            estimate,
            design,
            units,
            chain_power,
            kappa,
            rate_hz,
            plan,
        }
    }

    /// Spectrum of a record with the same missing samples, bin by bin.
    pub fn measure(&self, values: &[f64]) -> Vec<f64> {
        let mut cascade = Cascade::new(&self.plan);
        cascade
            .push_values(0, values)
            .expect("the first block is in order");
        estimate::bins(&cascade, self.rate_hz, &self.settings)
            .iter()
            .map(|bin| bin.psd)
            .collect()
    }

    /// Degrees of freedom of the bins, and their frequencies.
    pub fn bins(&self) -> &[estimate::Bin] {
        &self.estimate.bins
    }

    /// Expectations of the bins for a density ahead of the chain.
    pub fn expect(&self, density: impl Fn(f64) -> f64) -> Vec<f64> {
        let densities: Vec<f64> = self
            .estimate
            .operator
            .nodes_hz()
            .iter()
            .zip(&self.chain_power)
            .map(|(&f_hz, power)| density(f_hz) * power)
            .collect();
        self.estimate.operator.apply(&densities)
    }

    /// Expectations for each of [`RANDOM`] at coefficient 1.
    pub fn units(&self) -> &[Vec<f64>] {
        &self.units
    }

    /// The same through one more filter.
    pub fn units_through(&self, power: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
        RANDOM
            .iter()
            .map(|&one| self.expect(|f_hz| self.design.unit_spectrum(one, f_hz) * power(f_hz)))
            .collect()
    }

    /// Samples a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Two-sided density of the samples at `f_hz` for squared coefficients, chain included.
    pub fn density(&self, squared: &PerCoefficient<f64>, f_hz: f64) -> f64 {
        self.design.spectrum(squared, f_hz)
    }

    /// Share of the information on a common factor that is left as neighbouring bins vary together.
    pub fn kappa(&self) -> f64 {
        self.kappa
    }

    /// Log-likelihood of expectations.
    pub fn log_likelihood(&self, psd: &[f64], expected: &[f64]) -> f64 {
        let sum: f64 = psd
            .iter()
            .zip(expected)
            .zip(&self.estimate.bins)
            .map(|((&psd, &expected), bin)| 0.5 * bin.edf * (expected.ln() + psd / expected))
            .sum();
        -self.kappa * sum
    }

    /// The most likely sum of `components` (expectations for coefficient 1).
    ///
    /// `None` where no sum of them is above zero everywhere.
    pub fn fit(&self, psd: &[f64], components: &[Vec<f64>]) -> Option<Fitted> {
        self.fit_above(psd, components, &vec![0.0; psd.len()])
    }

    /// The same above something that is held.
    pub fn fit_above(
        &self,
        psd: &[f64],
        components: &[Vec<f64>],
        held: &[f64],
    ) -> Option<Fitted> {
        let left: Vec<f64> = psd.iter().zip(held).map(|(psd, held)| psd - held).collect();
        let mut weights_at: Vec<f64> = psd.to_vec();
        let mut best: Option<Fitted> = None;
        for _ in 0..ROUNDS {
            let squared = self.weighted(&left, components, &weights_at)?;
            let mut expected = sum(components, &squared);
            for (expected, held) in expected.iter_mut().zip(held) {
                *expected += held;
            }
            if expected.iter().any(|&value| value <= 0.0 || !value.is_finite()) {
                return best;
            }
            let log_likelihood = self.log_likelihood(psd, &expected);
            let gain = best
                .as_ref()
                .map_or(f64::INFINITY, |best| log_likelihood - best.log_likelihood);
            weights_at.clone_from(&expected);
            if gain > 0.0 {
                best = Some(Fitted {
                    squared,
                    expected,
                    log_likelihood,
                });
            }
            if gain.abs() < ARRIVED {
                break;
            }
        }
        best
    }

    /// Least squares with the weights of the expectations `at`, coefficients not negative.
    fn weighted(&self, psd: &[f64], components: &[Vec<f64>], at: &[f64]) -> Option<Vec<f64>> {
        let count = components.len();
        let mut gram = DMatrix::zeros(count, count);
        let mut right = DVector::zeros(count);
        let weights: Vec<f64> = self
            .estimate
            .bins
            .iter()
            .zip(at)
            .map(|(bin, at)| bin.edf / (at * at))
            .collect();
        for i in 0..count {
            for j in 0..=i {
                let sum: f64 = weights
                    .iter()
                    .zip(components[i].iter().zip(&components[j]))
                    .map(|(weight, (a, b))| weight * a * b)
                    .sum();
                gram[(i, j)] = sum;
                gram[(j, i)] = sum;
            }
            right[i] = weights
                .iter()
                .zip(components[i].iter().zip(psd))
                .map(|(weight, (a, p))| weight * a * p)
                .sum();
        }
        non_negative(&gram, &right)
    }
}

/// Sum of components.
pub fn sum(components: &[Vec<f64>], squared: &[f64]) -> Vec<f64> {
    let bins = components.first().map_or(0, Vec::len);
    let mut total = vec![0.0; bins];
    for (component, &squared) in components.iter().zip(squared) {
        if squared > 0.0 {
            for (total, value) in total.iter_mut().zip(component) {
                *total += squared * value;
            }
        }
    }
    total
}

/// Minimises `x' G x / 2 - r' x` over `x >= 0` by trying every choice of columns.
fn non_negative(gram: &DMatrix<f64>, right: &DVector<f64>) -> Option<Vec<f64>> {
    let count = right.len();
    // To unit diagonal: the columns differ by many powers of ten.
    let scale: Vec<f64> = (0..count).map(|i| gram[(i, i)].sqrt()).collect();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for choice in 1_u32..1 << count {
        let chosen: Vec<usize> = (0..count)
            .filter(|&i| choice >> i & 1 == 1 && scale[i] > 0.0)
            .collect();
        if chosen.len() != choice.count_ones() as usize {
            continue;
        }
        let part = DMatrix::from_fn(chosen.len(), chosen.len(), |i, j| {
            gram[(chosen[i], chosen[j])] / (scale[chosen[i]] * scale[chosen[j]])
        });
        let side = DVector::from_fn(chosen.len(), |i, _| right[chosen[i]] / scale[chosen[i]]);
        let Some(cholesky) = part.cholesky() else {
            continue;
        };
        let x = cholesky.solve(&side);
        if x.iter().any(|&value| value < 0.0 || !value.is_finite()) {
            continue;
        }
        let value = -0.5 * side.dot(&x);
        if best.as_ref().is_none_or(|(least, _)| value < *least) {
            let mut full = vec![0.0; count];
            for (&i, &value) in chosen.iter().zip(&x) {
                full[i] = value / scale[i];
            }
            best = Some((value, full));
        }
    }
    best.map(|(_, x)| x)
}

/// Information on a common factor, over what independent bins would hold.
fn kappa(estimate: &Estimate) -> f64 {
    let count = estimate.bins.len();
    let covariance = DMatrix::from_fn(count, count, |i, j| estimate.covariance.at(i, j));
    let independent: f64 = estimate.bins.iter().map(|bin| 0.5 * bin.edf).sum();
    let ones = DVector::from_element(count, 1.0);
    covariance
        .cholesky()
        .map(|cholesky| ones.dot(&cholesky.solve(&ones)) / independent)
        .filter(|kappa| kappa.is_finite() && *kappa > 0.0)
        .map_or(1.0, |kappa| kappa.min(1.0))
}
