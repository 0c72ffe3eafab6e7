//! Noise that is louder after it was loud: its strength lasts, and most of what stands out of it is no event.
//!
//! The square of each error of prediction is expected to be `h = c_0 + sum_k c_k s_k` of the squares before it, which
//! the `s_k` average over some times (as in T. Bollerslev, J. Econometrics 31 (1986), with a law of several times).
//! The weights maximise the likelihood of normal errors. What is
//! an event in such noise is what is loud beyond what was foretold.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::prediction::Prediction;
use crate::diagnosis::statistic::tails::{Rare, normal_of_log, normal_of_mean};
use crate::fit::likelihood::non_negative;
use crate::model::random::{Gaussian, Generator, Seed};

/// Samples that strengths are averaged over: choices. What changes within four is the law of single samples, what lasts
/// for longer than a thousand can be seen as a stretch.
const TIMES: [f64; 3] = [4.0, 32.0, 256.0];

/// Samples before a stretch that its foretold strength begins with: those that the longest average still holds.
const BEFORE: usize = 1024;

/// Samples that the weights rest on, at most, and in one piece: choices between time and certainty.
const SAMPLES: usize = 1 << 17;
const PIECE: usize = 1 << 13;

/// Gain in log-likelihood from which strength lasts: a choice. Steady noise gains as much once in ten thousand records,
/// and its events are then asked to stand out of little more.
const LASTS_NATS: f64 = 10.0;

/// Windows of an event that are compared, samples: choices.
const WINDOWS: [usize; 4] = [1, 8, 64, 512];

/// The law of the strength of some noise.
pub struct Lasting {
    prediction: Prediction,
    weights: Weights,
    /// Heights that are rare, for each of the [`WINDOWS`].
    rare: [Option<Rare>; WINDOWS.len()],
    /// Windows of an event stand out of more than these.
    trials: f64,
}

/// The constant part of the strength, and what the averages add.
type Weights = [f64; 1 + TIMES.len()];

impl Lasting {
    /// Of the `quiet` runs of a record, whose filter hides noise of the variance `faint`; `None` where its strength does
    /// not last.
    pub fn of(values: &[f64], quiet: &[Range<usize>], faint: f64) -> Option<Self> {
        let pieces = pieces(values, quiet, faint);
        let prediction = Prediction::new(&pieces)?;
        let squares: Vec<Vec<f64>> = pieces.iter().map(|one| squares(&prediction, one)).collect();
        let averages: Vec<Vec<Averages>> = squares.iter().map(|one| averages(one)).collect();
        let seen = || {
            let pairs = squares.iter().zip(&averages);
            pairs.flat_map(|(squares, averages)| squares.iter().copied().zip(averages.iter()))
        };
        let weights = fitted(seen);
        let pairs = || squares.iter().zip(&averages);
        if !lasts(seen, &weights) || !lasts_everywhere(pairs(), &weights) {
            return None;
        }
        let over: Vec<Vec<f64>> = squares
            .iter()
            .zip(&averages)
            .map(|(squares, averages)| over_foretold(squares, averages, &weights))
            .collect();
        let rare = WINDOWS.map(|len| {
            let windows = over.iter().flat_map(|one| one.chunks_exact(len));
            let heights = windows.map(height);
            // Single samples are far off for many a reason: they are held against the normal law.
            (len > 1).then(|| Rare::of(heights.collect())).flatten()
        });
        let quiet: usize = quiet.iter().map(Range::len).sum();
        Some(Self {
            prediction,
            weights,
            rare,
            trials: (quiet * WINDOWS.len()) as f64,
        })
    }

    /// Whether a stretch is no louder than what was before it foretells, at a `level`.
    pub fn foretells(&self, values: &[f64], samples: &Range<usize>, level: f64) -> bool {
        let threshold = normal_of_log((level / self.trials).ln());
        let from = samples.start.saturating_sub(BEFORE);
        let from = (from..samples.start)
            .rev()
            .find(|&n| !values[n].is_finite())
            .map_or(from, |hole| hole + 1);
        let level = match from..samples.start {
            before if before.is_empty() => mean(&values[samples.clone()]),
            before => mean(&values[before]),
        };
        let all = values[from..samples.end].iter().map(|value| value - level);
        let all: Vec<f64> = all.collect();
        let squares = squares(&self.prediction, &all);
        // What is added to noise of another kind lasts by more when it is at its loudest.
        let over = squares
            .iter()
            .zip(averages(&squares))
            .map(|(square, averages)| {
                let just_before = averages.into_iter().fold(0.0, f64::max);
                square / foretold(&self.weights, &averages).max(just_before)
            });
        let over: Vec<f64> = over.collect();
        let own = &over[samples.start - from..];
        let mut windows = WINDOWS.iter().zip(&self.rare);
        windows.all(|(&len, rare)| {
            let mut own = own.windows(len).step_by((len / 4).max(1));
            own.all(|window| {
                let height = height(window);
                rare.map_or(height, |rare| rare.normal(height)) < threshold
            })
        })
    }
}

/// Averages of squares before one.
type Averages = [f64; TIMES.len()];

/// Pieces of some runs from all over the record, about their means, with faint noise.
fn pieces(values: &[f64], quiet: &[Range<usize>], faint: f64) -> Vec<Vec<f64>> {
    let pieces = quiet.iter().flat_map(|run| {
        run.clone()
            .step_by(PIECE)
            .map(|from| from..(from + PIECE).min(run.end))
    });
    let pieces: Vec<Range<usize>> = pieces.filter(|piece| piece.len() >= BEFORE / 4).collect();
    let stride = pieces.len().div_ceil(SAMPLES / PIECE).max(1);
    let mut noise = Gaussian::new(Seed { seed: 0, stream: 0 }, faint.sqrt());
    let pieces = pieces.into_iter().step_by(stride).map(|piece| {
        let mut piece = values[piece].to_vec();
        let level = mean(&piece);
        piece.iter_mut().for_each(|value| *value -= level);
        noise.add_to(&mut piece);
        piece
    });
    pieces.collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Squares of the errors of prediction.
fn squares(prediction: &Prediction, piece: &[f64]) -> Vec<f64> {
    let errors = prediction.errors(piece);
    errors.into_iter().map(|error| error * error).collect()
}

/// Averages of the squares before each; of 1 before all.
fn averages(squares: &[f64]) -> Vec<Averages> {
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
fn foretold(weights: &Weights, averages: &Averages) -> f64 {
    let lasting = weights[1..].iter().zip(averages).map(|(c, s)| c * s);
    weights[0] + lasting.sum::<f64>()
}

/// Squares over what was foretold.
fn over_foretold(squares: &[f64], averages: &[Averages], weights: &Weights) -> Vec<f64> {
    let pairs = squares.iter().zip(averages);
    pairs
        .map(|(square, averages)| square / foretold(weights, averages))
        .collect()
}

/// How improbable the mean of some squares is, as a normal number.
fn height(squares: &[f64]) -> f64 {
    let count = squares.len() as f64;
    normal_of_mean(squares.iter().sum::<f64>() / count, 2.0 / (9.0 * count))
}

/// The weights of the largest likelihood, by Fisher's scoring under `>= 0`.
fn fitted<'a, I>(seen: impl Fn() -> I) -> Weights
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
fn lasts<'a, I>(seen: impl Fn() -> I, weights: &Weights) -> bool
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

/// Whether no piece speaks against the law, as some do where it comes of what happens in others.
///
/// Where a law holds, another is more likely by `e^n` once in `e^n` pieces at most (A. Wald, Ann. Math. Stat. 16 (1945) 117).
fn lasts_everywhere<'a>(
    pieces: impl ExactSizeIterator<Item = (&'a Vec<f64>, &'a Vec<Averages>)>,
    weights: &Weights,
) -> bool {
    /// Against this in all of the pieces, in nats: one record in twenty, a choice.
    const AGAINST: f64 = 3.0;
    let most = AGAINST + (pieces.len() as f64).ln();
    let mut against = pieces.map(|(squares, averages)| {
        let steady = mean(squares);
        let pairs = squares.iter().zip(averages);
        let nats = pairs.map(|(&square, averages)| {
            log_likelihood(square, steady) - log_likelihood(square, foretold(weights, averages))
        });
        nats.sum::<f64>()
    });
    against.all(|nats| nats < most)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVEL: f64 = 1e-4;

    /// Of noise whose variance feeds on itself, whether it foretells a hundred samples about its largest one, or, where
    /// something is added, about its middle.
    fn foretells(seed: u64, added: f64) -> Option<bool> {
        let feeds = 0.15;
        let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut variance = 1.0;
        let mut values: Vec<f64> = (0..70_001)
            .map(|_| {
                let value = f64::sqrt(variance) * normal.draw();
                variance = 1.0 - feeds - 0.82 + feeds * value * value + 0.82 * variance;
                value
            })
            .collect();
        let inside = 100..69_900;
        let largest = inside.max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()));
        let at = if added > 0.0 {
            35_000
        } else {
            largest.expect("many")
        };
        let event = at - 50..at + 50;
        values[at..at + 10]
            .iter_mut()
            .for_each(|value| *value += added);
        let quiet = [0..event.start, event.end..values.len()];
        let law = Lasting::of(&values, &quiet, 0.0)?;
        Some(law.foretells(&values, &event, LEVEL))
    }

    #[test]
    fn noise_that_feeds_on_itself_foretells_its_own_peaks_and_no_knock() {
        for seed in 0..10 {
            assert_eq!(foretells(seed, 0.0), Some(true), "seed {seed}");
            assert_eq!(foretells(seed, 20.0), Some(false), "seed {seed}");
        }
    }

    #[test]
    fn steady_noise_foretells_nothing() {
        for seed in 0..10 {
            let mut normal = Gaussian::new(Seed { seed, stream: 1 }, 1.0);
            let values: Vec<f64> = (0..50_021).map(|_| 5.0 + normal.draw()).collect();
            let all = [0..values.len()];
            assert!(Lasting::of(&values, &all, 0.0).is_none(), "seed {seed}");
        }
    }
}
