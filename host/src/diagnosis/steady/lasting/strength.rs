//! The strength that is foretold by what was before: its weights, their fit, and whether the law holds in all of a record.

use nalgebra::{DMatrix, DVector};

use super::mean;
use crate::fit::likelihood::non_negative;

/// Samples that strengths are averaged over: choices. What changes within four is the law of single samples, what lasts
/// for longer than a thousand can be seen as a stretch.
const TIMES: [f64; 3] = [4.0, 32.0, 256.0];

/// Gain in log-likelihood from which strength lasts: a choice. Steady noise gains as much once in ten thousand records,
/// and its events are then asked to stand out of little more.
const LASTS_NATS: f64 = 10.0;

/// The constant part of the strength, and what the averages add.
pub(super) type Weights = [f64; 1 + TIMES.len()];

/// Averages of squares before one.
pub(super) type Averages = [f64; TIMES.len()];

/// Averages of the squares before each; of 1 before all.
pub(super) fn averages(squares: &[f64]) -> Vec<Averages> {
    let mut state = [1.0; TIMES.len()];
    let next = squares.iter().map(|square| {
        let before = state;
        for (state, time) in state.iter_mut().zip(TIMES) {
            *state += (square - *state) / time;
        }
        before
    });
    next.collect()
}

/// The strength that is foretold.
pub(super) fn foretold(weights: &Weights, averages: &Averages) -> f64 {
    let lasting = weights[1..].iter().zip(averages).map(|(c, s)| c * s);
    weights[0] + lasting.sum::<f64>()
}

/// Squares over what was foretold.
pub(super) fn over_foretold(squares: &[f64], averages: &[Averages], weights: &Weights) -> Vec<f64> {
    let pairs = squares.iter().zip(averages);
    pairs
        .map(|(square, averages)| square / foretold(weights, averages))
        .collect()
}

/// The weights of the largest likelihood, by Fisher's scoring under `>= 0`.
pub(super) fn fitted<'a, I>(seen: impl Fn() -> I) -> Weights
where
    I: Iterator<Item = (f64, &'a Averages)>,
{
    /// Steps, each halfway to what the last weights call for: a thousandth of the first error is left.
    const STEPS: usize = 10;
    const SIZE: usize = 1 + TIMES.len();
    let mut weights = [0.7, 0.1, 0.1, 0.1];
    for _ in 0..STEPS {
        let (mut gram, mut right) = (DMatrix::zeros(SIZE, SIZE), DVector::zeros(SIZE));
        for (square, averages) in seen() {
            let h = foretold(&weights, averages);
            let part = |i: usize| if i == 0 { 1.0 } else { averages[i - 1] } / h;
            for i in 0..SIZE {
                right[i] += part(i) * square / h;
                for j in 0..SIZE {
                    gram[(i, j)] += part(i) * part(j);
                }
            }
        }
        let best = non_negative::solve(&gram, &right);
        for (weight, best) in weights.iter_mut().zip(best.iter()) {
            *weight = 0.5 * (*weight + best);
        }
    }
    weights
}

/// Log-likelihood of a square, less what all have.
fn log_likelihood(square: f64, strength: f64) -> f64 {
    -0.5 * (strength.ln() + square / strength)
}

/// Whether foretold strengths gain more than they cost over one strength.
pub(super) fn lasts<'a, I>(seen: impl Fn() -> I, weights: &Weights) -> bool
where
    I: Iterator<Item = (f64, &'a Averages)>,
{
    let (mut count, mut sum, mut fourth, mut score) = (0.0, 0.0, 0.0, 0.0);
    for (square, averages) in seen() {
        score += log_likelihood(square, foretold(weights, averages));
        count += 1.0;
        sum += square;
        fourth += square * square;
    }
    let mean: f64 = sum / count;
    let gain = score + 0.5 * count * (mean.ln() + 1.0);
    // Squares of a law with long tails scatter by more than by 2 times their mean squared.
    let scatter = (0.5 * (fourth / count / (mean * mean) - 1.0)).max(1.0);
    gain > scatter * LASTS_NATS
}

/// Whether no piece speaks against the law, and not one alone for it, as where it comes of what happens in others: the
/// first and the last footsteps of somebody who comes and goes, that stand out of nothing.
///
/// Where a law holds, another is more likely by `e^n` once in `e^n` pieces at most (A. Wald, Ann. Math. Stat. 16 (1945) 117).
pub(super) fn lasts_everywhere<'a>(
    pieces: impl ExactSizeIterator<Item = (&'a Vec<f64>, &'a Vec<Averages>)>,
    weights: &Weights,
) -> bool {
    /// Against this in all of the pieces, in nats: one record in twenty, a choice.
    const AGAINST: f64 = 3.0;
    let most = AGAINST + (pieces.len() as f64).ln();
    let gains = pieces.map(|(squares, averages)| {
        let steady = mean(squares);
        let pairs = squares.iter().zip(averages);
        let nats = pairs.map(|(&square, averages)| {
            log_likelihood(square, foretold(weights, averages)) - log_likelihood(square, steady)
        });
        nats.sum::<f64>()
    });
    let gains: Vec<f64> = gains.collect();
    let plainest = gains.iter().copied().fold(0.0, f64::max);
    let others = gains.iter().sum::<f64>() - plainest;
    gains.iter().all(|nats| *nats > -most) && (gains.len() < 2 || others > 0.0)
}
