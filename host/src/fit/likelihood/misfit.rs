//! Where a record does not follow the model: bins left out, and an error allowed for in the rest.
//!
//! Real records hold more than the terms that are fitted. Bins at high frequency are known to a
//! tenth of a percent, and would bend every coefficient for the sake of a line or a droop that the
//! model does not describe. So bins that lie beyond any chance are left out, and if the typical
//! one of the rest still lies further off than chance explains, each is allowed an error of its
//! own, the same fraction of the model everywhere and just as large as the misfit asks for. On a
//! record that follows the model nothing happens.

use super::data::Data;
use super::scoring::{Fit, maximise};
use crate::numeric::bisect::bisect;
use crate::numeric::mixture::add_mixture;
use crate::numeric::order::median;

/// Deviance from which a bin is left out: five standard deviations.
const BEYOND_CHANCE: f64 = 25.0;

/// Median of the chi-squared law of one degree of freedom.
const MEDIAN: f64 = 0.454_936;

/// Standard deviation of the median of `n` such numbers is this over the root of `n`.
const MEDIAN_SCATTER: f64 = 1.06;

/// Standard deviations of the median from which an error is allowed for; neighbours vary together,
/// which halves their number.
const SIGMAS: f64 = 4.0;

/// Degrees of freedom from which a bin shows a misfit.
const TELLING: f64 = 10.0;

/// Rounds of leaving out and allowing; two are usual.
const ROUNDS: usize = 12;

/// A fit with what had to be allowed for.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerant {
    /// The bins that were fitted, with their reduced claims.
    pub data: Data,
    /// Components' expectations of these bins.
    pub components: Vec<Vec<f64>>,
    /// The fit.
    pub fit: Fit,
    /// Error of the model's density that was allowed for in every bin, as a fraction of it.
    pub allowance: f64,
    /// Mean frequencies of bins that were left out, hertz.
    pub left_out_hz: Vec<f64>,
}

/// Fits `components` to `data`, tolerating what they do not describe.
///
/// `None` where there is no fit.
pub fn maximise_tolerant(data: &Data, components: &[Vec<f64>]) -> Option<Tolerant> {
    let mut state = (0.0, (0..data.len()).collect::<Vec<usize>>());
    let mut result = apply(data, components, &state)?;
    for _ in 0..ROUNDS {
        let expected = expectation(components, &result.fit.squared);
        let allowance = allowance(data, &expected);
        let kept: Vec<usize> = (0..data.len())
            .filter(|&b| deviance(data, &expected, allowance, b) < BEYOND_CHANCE)
            .collect();
        if kept.len() <= components.len() {
            break;
        }
        let settled = kept == state.1 && (allowance - state.0).abs() <= 0.02 * allowance;
        if settled {
            break;
        }
        state = (allowance, kept);
        result = apply(data, components, &state)?;
    }
    Some(result)
}

fn apply(
    data: &Data,
    components: &[Vec<f64>],
    (allowance, kept): &(f64, Vec<usize>),
) -> Option<Tolerant> {
    let chosen = data.select(kept, *allowance);
    let components: Vec<Vec<f64>> = components
        .iter()
        .map(|component| kept.iter().map(|&b| component[b]).collect())
        .collect();
    Some(Tolerant {
        fit: maximise(&chosen, &components)?,
        data: chosen,
        components,
        allowance: *allowance,
        left_out_hz: (0..data.len())
            .filter(|b| kept.binary_search(b).is_err())
            .map(|b| data.f_hz[b])
            .collect(),
    })
}

fn expectation(components: &[Vec<f64>], squared: &[f64]) -> Vec<f64> {
    let mut expected = vec![0.0; components.first().map_or(0, Vec::len)];
    add_mixture(&mut expected, components, squared);
    expected
}

/// Twice the log-likelihood that a bin would gain by an expectation of its own.
fn deviance(data: &Data, expected: &[f64], allowance: f64, b: usize) -> f64 {
    let dof = 2.0 / (data.covariance[(b, b)] + allowance * allowance);
    let ratio = data.psd[b] / expected[b];
    dof * (ratio - 1.0 - ratio.ln())
}

/// The allowance at which the typical deviance is that of chance; zero where it is without one.
fn allowance(data: &Data, expected: &[f64]) -> f64 {
    let telling: Vec<usize> = (0..data.len())
        .filter(|&b| 2.0 / data.covariance[(b, b)] >= TELLING)
        .collect();
    let typical = |allowance: f64| {
        let all = telling
            .iter()
            .map(|&b| deviance(data, expected, allowance, b));
        median(&mut all.collect::<Vec<f64>>()).unwrap_or(0.0)
    };
    let scatter = MEDIAN_SCATTER / (0.5 * telling.len().max(1) as f64).sqrt();
    if typical(0.0) <= MEDIAN + SIGMAS * scatter {
        return 0.0;
    }
    // Monotonous. A model that is off by more than a hundredfold everywhere is beyond help.
    bisect(0.0, 100.0, 60, |allowance| typical(allowance) > MEDIAN)
}

#[cfg(test)]
mod tests {
    use super::super::scoring::tests::synthetic;
    use super::*;

    fn components(data: &Data) -> Vec<Vec<f64>> {
        [-2, 0]
            .map(|power| data.f_hz.iter().map(|f| f.powi(power)).collect())
            .to_vec()
    }

    #[test]
    fn nothing_happens_to_what_follows_the_model() {
        for seed in 0..50 {
            let data = synthetic(seed, 1e6, |f| 1e-3 / (f * f) + 1.0);
            let fit = maximise_tolerant(&data, &components(&data)).expect("a fit");
            assert_eq!(fit.allowance, 0.0, "seed {seed}");
            assert!(
                fit.left_out_hz.is_empty(),
                "seed {seed}: {:?}",
                fit.left_out_hz
            );
        }
    }

    #[test]
    fn a_line_costs_its_bins_and_a_ripple_widens_the_intervals() {
        let truth = |f: f64| 1e-3 / (f * f) + 1.0;
        for seed in 0..20 {
            let line = |f: f64| if (f - 1.0).abs() < 0.05 { 1e3 } else { 1.0 };
            let data = synthetic(seed, 1e6, |f| truth(f) * line(f));
            let fit = maximise_tolerant(&data, &components(&data)).expect("a fit");
            assert!(
                fit.left_out_hz.iter().all(|f| (f - 1.0).abs() < 0.05),
                "seed {seed}: {:?}",
                fit.left_out_hz
            );
            let sigma = fit.fit.covariance[(1, 1)].sqrt();
            let error = fit.fit.squared[1] - 1.0;
            assert!(error.abs() < 5.0 * sigma, "seed {seed}: {error} {sigma}");

            let rippled = synthetic(seed, 1e6, |f| truth(f) * (1.0 + 0.1 * (5.0 * f.ln()).sin()));
            let fit = maximise_tolerant(&rippled, &components(&rippled)).expect("a fit");
            // A ripple of 10 % has a median size of 7 %.
            assert!(
                (0.04..0.15).contains(&fit.allowance),
                "seed {seed}: {}",
                fit.allowance
            );
            let sigma = fit.fit.covariance[(1, 1)].sqrt();
            let error = fit.fit.squared[1] - 1.0;
            assert!(error.abs() < 5.0 * sigma, "seed {seed}: {error} {sigma}");
        }
    }
}
