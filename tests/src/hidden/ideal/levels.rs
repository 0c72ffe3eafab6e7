//! Two levels against a Gaussian of the same variance: what tells telegraph from Markov noise.

use std::f64::consts::TAU;

use super::detector::Contrast;

/// Which of the two the data are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Data {
    /// Two levels and Gaussian noise.
    TwoLevels,
    /// Gaussian throughout.
    Gaussian,
}

/// Twice the log-likelihood ratio of `blocks` independent block means: the truth `data` against
/// the other, for levels `height` apart and noise of this variance within a block. By the
/// trapezium rule.
pub fn contrast(height: f64, noise_variance: f64, blocks: f64, data: Data) -> Contrast {
    const HALF: i32 = 2000;
    let wide = noise_variance + 0.25 * height * height;
    let step = 10.0 * wide.sqrt() / f64::from(HALF);
    let (mut mean, mut square) = (0.0, 0.0);
    for i in -HALF..=HALF {
        let x = f64::from(i) * step;
        let two = 0.5
            * (gauss(x - 0.5 * height, noise_variance) + gauss(x + 0.5 * height, noise_variance));
        let one = gauss(x, wide);
        let (truth, rival) = match data {
            Data::TwoLevels => (two, one),
            Data::Gaussian => (one, two),
        };
        if truth > 0.0 {
            let log_ratio = 2.0 * (truth.ln() - rival.max(f64::MIN_POSITIVE).ln());
            mean += truth * log_ratio * step;
            square += truth * log_ratio * log_ratio * step;
        }
    }
    Contrast {
        mean: blocks * mean,
        variance: blocks * (square - mean * mean),
    }
}

fn gauss(x: f64, variance: f64) -> f64 {
    (-0.5 * x * x / variance).exp() / (TAU * variance).sqrt()
}
