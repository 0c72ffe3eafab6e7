//! What the values themselves say, before any model: repeats (`repeats.rs`), pile-up at an extreme,
//! coarse steps.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, DefaultHasher};

use crate::diagnosis::detect::outliers::middle_spread;
use crate::diagnosis::detect::stale::{Chance, Stale, stale};
use crate::diagnosis::statistic::p_value;

/// Distinct values that are counted; with more, the values lie on no coarse grid.
const DISTINCT: usize = 1 << 17;

/// Probability that the next value equals the extreme, where no grid is coarse enough to be seen: the
/// two largest of a million normal numbers are a fifth of a deviation apart, and more distinct values
/// than are counted lie closer than a ten-thousandth.
const SHARED: f64 = 1.0 / 2048.0;

/// Samples that the first look takes.
const LOOK: usize = 1 << 20;

/// Step of a grid over the short-term noise below which chance repeats can be foretold: with few
/// steps in the noise its law, which a correlation of neighbours or a dither changes, decides.
const SPANNED: f64 = 0.25;

/// Step of a grid over the short-term noise, itself included, from which the noise looks stronger where
/// the level lies between two steps than where it lies on one.
const DECIDES: f64 = 2.0;

/// What the values themselves say.
#[derive(Debug, Clone, Default)]
pub struct CodeFindings {
    /// Repeats, and where they are.
    pub stale: Option<(Stale, Vec<usize>)>,
    /// Pile-ups, and where they are.
    pub clipping: Vec<(Clipping, Vec<usize>)>,
    /// Grid of the values that is coarser than declared, beside the short-term noise.
    pub coarse: Option<Coarse>,
    /// Largest size of a value: what its rounding is a share of.
    pub largest: f64,
}

/// A coarse grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coarse {
    /// Its step.
    pub step: f64,
    /// Whether the noise lies on so few steps that where the level is between two of them decides how
    /// strong it looks.
    pub decides: bool,
}

impl CodeFindings {
    /// Of an axis in its unit, `measured` about its `mean`, at the `level` of one test; `declared` is
    /// the step of its codes, where it has any.
    pub fn new(declared: Option<f64>, level: f64, measured: &[f64], mean: f64) -> Self {
        let grid = grid(measured);
        let increments: Vec<f64> = measured
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| step.is_finite())
            .collect();
        // From the spread of increments, so that wander does not count.
        let squares: f64 = increments.iter().map(|step| step * step).sum();
        let rms = (0.5 * squares / increments.len() as f64).sqrt();
        let middle = middle_spread(&increments) / std::f64::consts::SQRT_2;
        let noise = middle.max(0.5 * rms);
        let coarse = grid.filter(|&step| {
            let coarser = declared.is_none_or(|declared| step > 1.5 * declared.abs());
            coarser && step > 0.25 * noise
        });
        let coarse = coarse.map(|step| Coarse {
            step,
            decides: step > DECIDES * rms,
        });
        let clipping = clipping(measured, grid, level);
        // On a grid that the noise does not span, repeats are no news.
        let spanned = grid.is_none_or(|step| step < SPANNED * noise);
        let chance = match grid {
            Some(grid) => Chance::on_grid(&increments, grid),
            None => Chance::between(&increments, noise, declared.map(f64::abs)),
        };
        let repeats: Vec<usize> = (1..measured.len())
            .filter(|&n| measured[n] == measured[n - 1])
            // Samples at a limit are all the same for another reason.
            .filter(|&n| clipping.iter().all(|one| measured[n] != one.level))
            .collect();
        let pairs = increments.len();
        let stale = stale(repeats.len(), pairs, chance, level).filter(|_| spanned);
        Self {
            stale: stale.map(|stale| (stale, repeats)),
            clipping: clipping
                .into_iter()
                .map(|one| {
                    let reached = |value: f64| one.side * value >= one.side * one.level;
                    let places = (0..measured.len()).filter(|&n| reached(measured[n]));
                    let about_zero = Clipping {
                        level: one.level + mean,
                        ..one
                    };
                    (about_zero, places.collect())
                })
                .collect(),
            coarse,
            largest: measured
                .iter()
                .filter(|value| value.is_finite())
                .fold(mean.abs(), |most, value| most.max((value + mean).abs())),
        }
    }
}

/// Samples piled up at one extreme value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clipping {
    /// The extreme value.
    pub level: f64,
    /// +1 upper, -1 lower.
    pub side: f64,
    /// Samples there.
    pub count: u64,
    /// Probability of the pile-up by chance.
    pub p_value: f64,
}

/// Pile-up at the largest and at the smallest value.
///
/// Toward an extreme the counts of any smooth law fall off, so at most half of the samples in the
/// last two cells lie in the last; without a grid the last cell is the value itself.
pub fn clipping(values: &[f64], grid: Option<f64>, level: f64) -> Vec<Clipping> {
    let side = |side: f64| {
        let extreme = values
            .iter()
            .filter(|value| value.is_finite())
            .fold(f64::NEG_INFINITY, |best, value| best.max(side * value));
        let at = |distance: f64| {
            let place = |value: &&f64| match grid {
                Some(grid) => ((extreme - side * **value) / grid - distance).abs() < 0.5,
                None => distance == 0.0 && side * **value == extreme,
            };
            values.iter().filter(place).count() as u64
        };
        let (last, before) = (at(0.0), at(1.0));
        let one_side = match grid {
            Some(_) => p_value::binomial_half(last, last + before),
            None => SHARED.powi(last.saturating_sub(1).min(64) as i32),
        };
        let p_value = p_value::searched(one_side, 2.0);
        (p_value < level).then_some(Clipping {
            level: side * extreme,
            side,
            count: last,
            p_value,
        })
    };
    [side(1.0), side(-1.0)].into_iter().flatten().collect()
}

/// The grid that all values lie on: its step, where they lie on one that is not finer than 2^-17
/// of their range.
pub fn grid(values: &[f64]) -> Option<f64> {
    type Counts = HashMap<u64, u32, BuildHasherDefault<DefaultHasher>>;
    let mut seen = Counts::default();
    for value in values.iter().filter(|value| value.is_finite()).take(LOOK) {
        *seen.entry(value.to_bits()).or_default() += 1;
        if seen.len() > DISTINCT {
            return None;
        }
    }
    if seen.len() < 2 {
        return None;
    }
    let mut distinct: Vec<f64> = seen.into_keys().map(f64::from_bits).collect();
    distinct.sort_by(f64::total_cmp);
    let range = distinct[distinct.len() - 1] - distinct[0];
    // Rounding of the file's numbers; a true grid's step lies far above.
    let slack = 1e-9 * range.max(distinct[0].abs());
    let mut step = distinct
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|gap| *gap > slack)
        .fold(f64::INFINITY, f64::min);
    // The least distance between neighbours need not be the grid's step itself: take what divides
    // all distances.
    for pair in distinct.windows(2) {
        let mut rest = (pair[1] - pair[0]) % step;
        rest = rest.min(step - rest);
        if rest > 0.02 * step && rest > slack {
            step = rest;
        }
        if step < range / DISTINCT as f64 {
            return None;
        }
    }
    // A few values by themselves lie on no grid.
    let used = distinct.len() as f64;
    let repeated = values.len().min(LOOK) as f64 > 1.5 * used;
    (repeated && step.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::Seed;
    use crate::model::random::Gaussian;

    /// What is made of normal numbers, one after the other.
    fn found(seed: u64, mut make: impl FnMut(f64) -> f64) -> CodeFindings {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let values: Vec<f64> = (0..1 << 15).map(|_| make(noise.draw())).collect();
        CodeFindings::new(None, 2e-4, &values, 0.0)
    }

    #[test]
    fn samples_at_a_limit_do_not_repeat_for_another_reason() {
        // A walk stays at its limit for many samples.
        let mut level = 0.0;
        let found = found(1, |step| {
            level += step;
            f64::min(level, 20.0)
        });
        assert_eq!(found.clipping.len(), 1, "seed 1");
        assert!(found.clipping[0].1.len() > 100, "seed 1");
        assert!(found.stale.is_none(), "seed 1: {:?}", found.stale);
    }

    #[test]
    fn a_grid_decides_from_some_two_deviations_on() {
        for (step, decides) in [(1.0, false), (4.0, true)] {
            let found = found(2, |z| step * (z / step).round());
            let coarse = found.coarse.expect("a grid that nobody declared");
            assert_eq!(coarse, Coarse { step, decides }, "seed 2");
        }
    }
}
