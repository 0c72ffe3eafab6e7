//! Numbers that were not measured: each is foretold from those before it, and told better by those that follow.
//!
//! R. E. Kalman, *J. Basic Eng.* 82 (1960) 35, for noise that a [`Prediction`] knows: what a number that is there adds to those
//! before it has the same law whatever is missing between them, so that a course is as likely as what was measured of it
//! says.

use super::prediction::Prediction;
use crate::diagnosis::record::bridge::bridge;
use crate::model::random::{Gaussian, Seed};

/// What predicts some stretches of noise about their means, which become whole; `None` where they are too short, or do not
/// change. No numbers where samples are missing.
pub fn prediction(stretches: &mut [Vec<f64>]) -> Option<Prediction> {
    /// Part of what a first prediction is wrong about that decides nothing: a choice, four rounds where three of ten are missing.
    const NOTHING: f64 = 3e-3;
    let is_missing: Vec<Vec<bool>> = stretches.iter().map(|one| missing(one)).collect();
    for stretch in stretches.iter_mut() {
        bridge(stretch);
        let mean = stretch.iter().sum::<f64>() / stretch.len() as f64;
        stretch.iter_mut().for_each(|value| *value -= mean);
    }
    let mut prediction = Prediction::new(stretches)?;
    let all = is_missing.iter().flatten();
    let count = all.clone().count() as f64;
    let share = all.filter(|is_missing| **is_missing).count() as f64 / count;
    let mut normal = Gaussian::new(Seed { seed: 0, stream: 0 }, 1.0);
    // Put in anew as the last prediction has it, what is missing leaves of what that was wrong about no more than its share.
    let mut left = share;
    while left > NOTHING {
        for (stretch, is_missing) in stretches.iter_mut().zip(&is_missing) {
            Whitener::new(&prediction, is_missing).fill(stretch, &mut normal);
        }
        prediction = Prediction::new(stretches)?;
        left *= share;
    }
    Some(prediction)
}

/// Which of some values are no numbers.
pub fn missing(values: &[f64]) -> Vec<bool> {
    values.iter().map(|value| !value.is_finite()).collect()
}

/// Whitens sequences of which the same numbers are missing.
pub struct Whitener {
    /// Weights of the numbers before one, by how many there are.
    weights: Vec<Vec<f64>>,
    /// Deviations of the errors, by how many there are.
    deviations: Vec<f64>,
    steps: Vec<Step>,
}

/// What one number adds to those before it.
#[derive(Default)]
struct Step {
    /// Deviation of the error with which it is foretold; infinite where it is missing.
    deviation: f64,
    /// How far back missing numbers are, and what an error of 1 adds to them.
    corrections: Vec<(usize, f64)>,
}

/// Missing numbers that those to come are foretold from, and the covariance of their errors.
#[derive(Default)]
struct Unknown {
    places: Vec<usize>,
    covariance: Vec<Vec<f64>>,
}

impl Whitener {
    /// For sequences of which those numbers are missing for which `is_missing` is true.
    pub fn new(prediction: &Prediction, is_missing: &[bool]) -> Self {
        let weights = prediction.weights();
        let most = weights.len() - 1;
        let mut unknown = Unknown::default();
        let steps = is_missing.iter().enumerate().map(|(n, is_missing)| {
            let known = n.min(most);
            let deviation = prediction.deviations()[known];
            unknown.forget(n - known);
            unknown.step(n, &weights[known], deviation, *is_missing)
        });
        Self {
            steps: steps.collect(),
            deviations: prediction.deviations().to_vec(),
            weights,
        }
    }

    /// Errors with which the numbers from `from` on are foretold, in their deviations, zero where they are missing, where all
    /// before are zero; `values` becomes what is known of it afterwards.
    pub fn errors_from(&self, from: usize, values: &mut [f64]) -> Vec<f64> {
        let most = self.weights.len() - 1;
        let steps = self.steps[from..].iter().take(values.len()).enumerate();
        let errors = steps.map(|(n, step)| {
            let weights = &self.weights[most.min(from + n)];
            let foretold = foretold(weights, &values[..n]);
            if step.deviation.is_infinite() {
                values[n] = foretold;
                return 0.0;
            }
            let error = values[n] - foretold;
            for &(back, gain) in &step.corrections {
                if let Some(place) = n.checked_sub(back) {
                    values[place] += gain * error;
                }
            }
            error / step.deviation
        });
        errors.collect()
    }

    /// Errors with which numbers are foretold, in their deviations; zero where they are missing.
    pub fn errors(&self, values: &[f64]) -> Vec<f64> {
        self.errors_from(0, &mut values.to_vec())
    }

    /// Puts in for what is missing what it may have been: J. Durbin and S. J. Koopman, Biometrika 89 (2002) 603.
    pub fn fill(&self, values: &mut [f64], normal: &mut Gaussian) {
        let other = self.drawn(values.len(), normal);
        let apart = |values: &mut [f64], sign: f64| {
            let both = values.iter_mut().zip(&other);
            both.for_each(|(value, other)| *value += sign * other);
        };
        apart(values, -1.0);
        self.errors_from(0, values);
        apart(values, 1.0);
    }

    /// Numbers of the same law as those that are foretold, none of them missing.
    fn drawn(&self, len: usize, normal: &mut Gaussian) -> Vec<f64> {
        let most = self.weights.len() - 1;
        let mut all: Vec<f64> = Vec::with_capacity(len);
        for n in 0..len {
            let known = n.min(most);
            let foretold = foretold(&self.weights[known], &all);
            all.push(foretold + self.deviations[known] * normal.draw());
        }
        all
    }
}

/// What the numbers before one foretell of it.
fn foretold(weights: &[f64], before: &[f64]) -> f64 {
    let both = weights.iter().zip(before.iter().rev());
    both.map(|(weight, value)| weight * value).sum()
}

impl Unknown {
    /// Leaves out what lies before `first`: nothing is foretold from it any more.
    fn forget(&mut self, first: usize) {
        let gone = self.places.partition_point(|place| *place < first);
        self.places.drain(..gone);
        self.covariance.drain(..gone);
        for row in &mut self.covariance {
            row.drain(..gone);
        }
    }

    /// What the number `n` adds, which is foretold with these `weights` and this `deviation` where nothing is missing.
    fn step(&mut self, n: usize, weights: &[f64], deviation: f64, is_missing: bool) -> Step {
        let of_unknown = |row: &Vec<f64>| -> f64 {
            let both = row.iter().zip(&self.places);
            both.map(|(one, place)| one * weights[n - 1 - place]).sum()
        };
        let with: Vec<f64> = self.covariance.iter().map(of_unknown).collect();
        let variance = deviation * deviation + of_unknown(&with);
        if is_missing {
            for (row, with) in self.covariance.iter_mut().zip(&with) {
                row.push(*with);
            }
            self.covariance.push([with, vec![variance]].concat());
            self.places.push(n);
            return Step {
                deviation: f64::INFINITY,
                corrections: Vec::new(),
            };
        }
        for (row, one) in self.covariance.iter_mut().zip(&with) {
            let both = row.iter_mut().zip(&with);
            both.for_each(|(cell, other)| *cell -= one * other / variance);
        }
        let gains = self.places.iter().zip(&with);
        Step {
            deviation: variance.sqrt(),
            corrections: gains
                .map(|(place, with)| (n - place, with / variance))
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::numbers;

    /// A walk that comes back, and what foretells it.
    fn walk(seed: u64, len: usize) -> (Vec<f64>, Prediction) {
        let mut normal = numbers(seed, 0);
        let mut level = 0.0;
        let mut walk = |len: usize| -> Vec<f64> {
            let values = (0..len).map(|_| {
                level = 0.95 * level + normal.draw();
                level
            });
            values.collect()
        };
        let prediction = Prediction::new(&[walk(1 << 14)]).expect("noise");
        (walk(len), prediction)
    }

    #[test]
    fn errors_are_white_and_of_deviation_1_whatever_is_missing() {
        // A normal number above 0.5 comes three times of ten.
        for (seed, above) in [(1, 9.0), (2, 0.5), (3, -1.0)] {
            let (values, prediction) = walk(seed, 20_000);
            let mut normal = numbers(seed, 1);
            let is_missing: Vec<bool> = values.iter().map(|_| normal.draw() > above).collect();
            let errors = Whitener::new(&prediction, &is_missing).errors(&values);
            let seen: Vec<f64> = errors
                .iter()
                .zip(&is_missing)
                .filter(|(_, is_missing)| !**is_missing)
                .map(|(error, _)| *error)
                .collect();
            let count = seen.len() as f64;
            let square = seen.iter().map(|one| one * one).sum::<f64>() / count;
            let next = seen.windows(2).map(|two| two[0] * two[1]).sum::<f64>() / count;
            // Five deviations of means over so many, and a law that is known to some percent.
            let sd = count.sqrt().recip();
            assert!(
                (square - 1.0).abs() < 5.0 * 1.42 * sd + 0.05,
                "seed {seed}: {square}"
            );
            assert!(next.abs() < 5.0 * sd + 0.02, "seed {seed}: {next}");
        }
    }

    #[test]
    fn noise_of_which_a_third_is_missing_foretells_the_same_noise() {
        for seed in 4..7 {
            let (mut values, _) = walk(seed, 1 << 14);
            let (whole, _) = walk(seed + 100, 1 << 14);
            let mut normal = numbers(seed, 1);
            values
                .iter_mut()
                .filter(|_| normal.draw() > 0.5)
                .for_each(|value| *value = f64::NAN);
            let prediction = prediction(&mut [values]).expect("noise");
            let errors = prediction.errors(&whole);
            let square = errors.iter().map(|one| one * one).sum::<f64>() / errors.len() as f64;
            // 16 384 squares scatter by 1.1 %, what is put in for as many by some more; lines across the gaps make 1.3.
            assert!((square - 1.0).abs() < 0.1, "seed {seed}: {square}");
        }
    }
}
