//! What neighbours say of a sample: the prediction error of noise about an event.
//!
//! J. P. Burg's method (*Maximum entropy spectral analysis*, Stanford 1975) on stretches beside the event, where
//! nothing happens. Its lattice gives predictors of all orders: the first sample of a stretch is predicted from
//! none, the second from one, so that nothing is lost where the event stands at an end of the record.

/// A sample is predicted from as many before it, at most: a choice.
pub const ORDER: usize = 32;

/// Samples that one coefficient rests on, at least: a choice.
const RESTS_ON: usize = 16;

/// A lattice that predicts samples of some noise.
#[derive(Clone)]
pub struct Prediction {
    reflections: Vec<f64>,
    /// Deviations of the errors by order, from that of no prediction.
    deviations: Vec<f64>,
}

impl Prediction {
    /// Of stretches of the noise; `None` where they are too short, or do not change.
    pub fn new(stretches: &[Vec<f64>]) -> Option<Self> {
        let mut forward: Vec<Vec<f64>> = stretches.iter().map(|one| about_mean(one)).collect();
        let mut backward = forward.clone();
        let count: usize = forward.iter().map(Vec::len).sum();
        let square: f64 = forward.iter().flatten().map(|value| value * value).sum();
        if count < 4 * RESTS_ON || square <= 0.0 {
            return None;
        }
        let mut deviations = vec![(square / count as f64).sqrt()];
        let mut reflections = Vec::new();
        for order in 1..=ORDER.min(count / RESTS_ON) {
            let (mut both, mut squares) = (0.0, 0.0);
            for (f, b) in forward.iter().zip(&backward) {
                for n in order..f.len() {
                    both += f[n] * b[n - 1];
                    squares += f[n] * f[n] + b[n - 1] * b[n - 1];
                }
            }
            let reflection = -2.0 * both / squares;
            if !reflection.is_finite() || reflection.abs() >= 1.0 {
                break;
            }
            for (f, b) in forward.iter_mut().zip(&mut backward) {
                step(reflection, order, f, b);
            }
            reflections.push(reflection);
            let last = deviations[order - 1];
            deviations.push(last * (1.0 - reflection * reflection).sqrt());
        }
        Some(Self {
            reflections,
            deviations,
        })
    }

    /// Weights of the samples before one in what is foretold of it, the nearest first: by how many there are, from none on.
    /// N. Levinson, J. Math. Phys. 25 (1947) 261.
    pub fn weights(&self) -> Vec<Vec<f64>> {
        let mut all = vec![Vec::new()];
        for (last, reflection) in self.reflections.iter().enumerate() {
            let before: &Vec<f64> = &all[last];
            let both = before.iter().zip(before.iter().rev());
            let mut weights: Vec<f64> = both.map(|(own, far)| own + reflection * far).collect();
            weights.push(-reflection);
            all.push(weights);
        }
        all
    }

    /// Deviations of the errors, by how many samples are before one.
    pub fn deviations(&self) -> &[f64] {
        &self.deviations
    }

    /// Errors of the predictions of all samples of a stretch, in their deviations.
    pub fn errors(&self, values: &[f64]) -> Vec<f64> {
        let (mut forward, mut backward) = (values.to_vec(), values.to_vec());
        let mut errors = vec![0.0; values.len()];
        let orders = self.reflections.len();
        for order in 0..=orders {
            if order > 0 {
                step(
                    self.reflections[order - 1],
                    order,
                    &mut forward,
                    &mut backward,
                );
            }
            if order < orders && order < errors.len() {
                errors[order] = forward[order] / self.deviations[order];
            }
        }
        for n in orders..errors.len() {
            errors[n] = forward[n] / self.deviations[orders];
        }
        errors
    }
}

/// One order more, of the errors forward and backward.
fn step(reflection: f64, order: usize, forward: &mut [f64], backward: &mut [f64]) {
    for n in (order..forward.len()).rev() {
        let (f, b) = (forward[n], backward[n - 1]);
        forward[n] = f + reflection * b;
        backward[n] = b + reflection * f;
    }
}

fn about_mean(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|value| value - mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::{Gaussian, Seed};

    #[test]
    fn errors_of_correlated_noise_are_white_from_the_first_sample_on() {
        let mut firsts = 0.0;
        for seed in 0..200 {
            let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
            let mut level = 0.0;
            let mut noise = |count: usize| -> Vec<f64> {
                let values = (0..count).map(|_| {
                    level = 0.9 * level + normal.draw();
                    level
                });
                values.collect()
            };
            let prediction = Prediction::new(&[noise(4096), noise(4096)]).expect("long enough");
            let errors = prediction.errors(&noise(2048));
            let square = errors.iter().map(|one| one * one).sum::<f64>() / 2048.0;
            // A mean square of 2048 numbers scatters by 3 %, that of the 8192 it is compared with by 1.6 %.
            assert!((square - 1.0).abs() < 0.17, "seed {seed}: {square}");
            firsts += errors[0] * errors[0];
        }
        // The mean square of 200 numbers scatters by 10 %.
        assert!((firsts / 200.0 - 1.0).abs() < 0.5, "{firsts}");
    }
}
