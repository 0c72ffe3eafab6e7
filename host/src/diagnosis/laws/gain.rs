//! What one more component is worth to a spectrum, when nothing else moves.

use std::ops::Range;

use crate::fit::likelihood::Data;

/// Steps of Fisher scoring: from a start that is right where the component is far above or far below
/// all else, five leave less than a thousandth of a nat.
const STEPS: usize = 6;

/// A component where it counts: some neighbouring bins.
#[derive(Debug, Clone)]
pub struct Local {
    /// Number of the first bin.
    pub first: usize,
    /// Expectations of the bins from there on, for a square of 1.
    pub expected: Vec<f64>,
    /// Largest square that it may have.
    pub most: f64,
}

impl Local {
    /// Numbers of the bins.
    fn bins(&self) -> Range<usize> {
        self.first..self.first + self.expected.len()
    }

    /// Expectations of all of so many bins.
    pub fn whole(&self, bins: usize) -> Vec<f64> {
        let mut whole = vec![0.0; bins];
        whole[self.bins()].copy_from_slice(&self.expected);
        whole
    }

    /// The likeliest square beside `others`, the expectation of all else in every bin, and its gain in
    /// log-likelihood, nats; zeros where none would be better.
    pub fn best(&self, data: &Data, others: &[f64]) -> (f64, f64) {
        let bins = || self.bins().zip(&self.expected);
        let mut squared = 0.0;
        for _ in 0..STEPS {
            let (mut slope, mut weight) = (0.0, 0.0);
            for (bin, own) in bins() {
                let expected = others[bin] + squared * own;
                let share = own / expected;
                slope += data.dof[bin] * share * (data.psd[bin] - others[bin]) / expected;
                weight += data.dof[bin] * share * share;
            }
            if !(slope > 0.0 && weight > 0.0) {
                return (0.0, 0.0);
            }
            squared = (slope / weight).min(self.most);
        }
        let gain = bins().map(|(bin, own)| {
            let (before, after) = (others[bin], others[bin] + squared * own);
            let psd = data.psd[bin];
            data.dof[bin] * ((before / after).ln() + psd / before - psd / after)
        });
        (squared, 0.5 * gain.sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::fit::likelihood::scoring::maximise_beside;

    #[test]
    fn the_square_is_the_likeliest() {
        // A peak far above a floor, one like it, and one that is not there.
        for (height, count) in [(300.0, 9), (1.0, 5), (0.0, 5)] {
            let own: Vec<f64> = (0..count).map(|k| 1.0 / f64::from(1 + k * k)).collect();
            let psd = own.iter().enumerate().map(|(k, one)| {
                let ripple = if k % 2 == 0 { 1.03 } else { 0.97 };
                ripple * (1.0 + height * one)
            });
            let variances = DVector::from_element(own.len(), 0.02);
            let data = Data::from_parts(
                vec![1.0; own.len()],
                psd.collect(),
                DMatrix::from_diagonal(&variances),
            )
            .expect("positive densities");
            let floor = vec![1.0; own.len()];
            let fit = maximise_beside(&data, std::slice::from_ref(&own), &floor, None);
            let expected = fit.expect("a fit").squared[0];
            let local = Local {
                first: 0,
                expected: own,
                most: f64::INFINITY,
            };
            let (squared, gain) = local.best(&data, &floor);
            assert!(
                (squared - expected).abs() < 1e-3 * (1.0 + expected),
                "{height}: {squared} {expected}"
            );
            assert!(gain >= 0.0, "{height}: {gain}");
        }
    }
}
