//! Noise that is louder after it was loud: its strength lasts, and most of what stands out of it is no event.
//!
//! The square of each error of prediction is expected to be `h = c_0 + sum_k c_k s_k` of the squares before it, which
//! the `s_k` average over some times (as in T. Bollerslev, J. Econometrics 31 (1986), with a law of several times).
//! The weights maximise the likelihood of normal errors. What is
//! an event in such noise is what is loud beyond what was foretold.

mod strength;

use std::ops::Range;

use super::gaps::{self, Whitener, missing};
use super::prediction::Prediction;
use crate::diagnosis::statistic::tails::{Rare, normal_of_log, normal_of_mean};
use crate::model::random::{Gaussian, Generator, Seed};
use strength::{Averages, Weights, averages, fitted, lasts, lasts_everywhere, over_foretold};

/// Samples before a stretch that its foretold strength begins with: those that the longest average still holds.
const BEFORE: usize = 1024;

/// Samples that the weights rest on, at most, and in one piece: choices between time and certainty.
const SAMPLES: usize = 1 << 17;
const PIECE: usize = 1 << 13;

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

impl Lasting {
    /// Of the `quiet` runs of a record, whose filter hides noise of the variance `faint`; `None` where its strength does
    /// not last.
    pub fn of(values: &[f64], quiet: &[Range<usize>], faint: f64) -> Option<Self> {
        let pieces = pieces(values, quiet, faint);
        let prediction = gaps::prediction(&mut pieces.clone())?;
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
        let before = &values[from..samples.start];
        let there = before.iter().filter(|value| value.is_finite()).count();
        let level = match there {
            0 => mean(&values[samples.clone()]),
            _ => mean(before),
        };
        let all = values[from..samples.end].iter().map(|value| value - level);
        let all: Vec<f64> = all.collect();
        let squares = squares(&self.prediction, &all);
        let over = over_foretold(&squares, &averages(&squares), &self.weights);
        let own = &over[there..];
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

/// Mean of what is there of some values.
fn mean(values: &[f64]) -> f64 {
    let there = values.iter().filter(|value| value.is_finite());
    there.clone().sum::<f64>() / there.count() as f64
}

/// Squares of the errors of prediction of what is there: what bridges a gap is quieter, and its strength would seem to last.
fn squares(prediction: &Prediction, piece: &[f64]) -> Vec<f64> {
    let is_missing = missing(piece);
    let errors = Whitener::new(prediction, &is_missing).errors(piece);
    let there = errors.into_iter().zip(is_missing);
    let there = there.filter(|(_, is_missing)| !is_missing);
    there.map(|(error, _)| error * error).collect()
}

/// How improbable the mean of some squares is, as a normal number.
fn height(squares: &[f64]) -> f64 {
    let count = squares.len() as f64;
    normal_of_mean(squares.iter().sum::<f64>() / count, 2.0 / (9.0 * count))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVEL: f64 = 1e-4;

    /// Noise whose variance is the part `feeds` of the last square, the part `lasts` of itself, and a constant.
    fn feeding(seed: u64, feeds: f64, lasts: f64) -> Vec<f64> {
        let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut variance = 1.0;
        let values = (0..70_001).map(|_| {
            let value = f64::sqrt(variance) * normal.draw();
            variance = 1.0 - feeds - lasts + feeds * value * value + lasts * variance;
            value
        });
        values.collect()
    }

    /// Of noise whose variance feeds on itself, whether it foretells a hundred samples about its largest one, or, where
    /// something is added, about its middle.
    fn foretells(seed: u64, added: f64, is_whole: bool) -> Option<bool> {
        let mut values = feeding(seed, 0.15, 0.82);
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
        if !is_whole {
            values
                .iter_mut()
                .skip(seed as usize % 7)
                .step_by(7)
                .for_each(|one| *one = f64::NAN);
        }
        let quiet = [0..event.start, event.end..values.len()];
        let law = Lasting::of(&values, &quiet, 0.0)?;
        Some(law.foretells(&values, &event, LEVEL))
    }

    #[test]
    fn noise_that_feeds_on_itself_foretells_its_own_peaks_and_no_knock() {
        for seed in 0..10 {
            for is_whole in [true, false] {
                let foretells = |added| foretells(seed, added, is_whole);
                assert_eq!(foretells(0.0), Some(true), "seed {seed}, {is_whole}");
                assert_eq!(foretells(20.0), Some(false), "seed {seed}, {is_whole}");
            }
        }
    }

    #[test]
    fn what_grows_slowly_is_not_foretold_by_its_own_beginning() {
        for seed in 50..54 {
            // Little of the variance feeds on itself, as where a machine is heard now and then.
            let mut values = feeding(seed, 0.15, 0.3);
            // A hand that comes and goes: up to six times as loud, by a tenth in 16 samples.
            let event = 35_000..35_600;
            for (n, value) in values[event.clone()].iter_mut().enumerate() {
                *value *= 1.0 + 5.0 * (std::f64::consts::PI * n as f64 / 600.0).sin();
            }
            let quiet = [0..event.start, event.end..values.len()];
            let law = Lasting::of(&values, &quiet, 0.0).expect("it feeds on itself");
            assert!(!law.foretells(&values, &event, LEVEL), "seed {seed}");
            let quieter = 50_000..50_600;
            assert!(law.foretells(&values, &quieter, LEVEL), "seed {seed}");
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

    #[test]
    fn noise_that_is_louder_for_a_while_has_no_law_of_its_strength() {
        for seed in 20..23 {
            let mut normal = Gaussian::new(Seed { seed, stream: 1 }, 1.0);
            let mut values: Vec<f64> = (0..70_001).map(|_| normal.draw()).collect();
            values[30_000..34_000]
                .iter_mut()
                .for_each(|value| *value *= 2.0);
            let all = [0..values.len()];
            assert!(Lasting::of(&values, &all, 0.0).is_none(), "seed {seed}");
        }
    }

    #[test]
    fn what_happens_in_one_piece_is_no_law_of_the_strength() {
        for seed in 30..34 {
            let mut normal = Gaussian::new(Seed { seed, stream: 1 }, 1.0);
            let mut values: Vec<f64> = (0..70_001).map(|_| normal.draw()).collect();
            // Knocks one after the other, each too small to stand out.
            for at in (30_000..34_000).step_by(200) {
                for (n, value) in values[at..at + 40].iter_mut().enumerate() {
                    *value *= 1.0 + 1.2 * (-(n as f64) / 15.0).exp();
                }
            }
            let all = [0..values.len()];
            assert!(Lasting::of(&values, &all, 0.0).is_none(), "seed {seed}");
        }
    }
}
