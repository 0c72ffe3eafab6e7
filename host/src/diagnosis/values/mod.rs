//! What the values themselves say, before any model: repeats, pile-up at an extreme, coarse steps.

pub mod chance;
pub mod extremes;
pub mod grid;
pub mod repeats;

use self::chance::Chance;
use self::extremes::{Clipping, clipping};
use self::grid::{Coarse, grid};
use self::repeats::{Repeats, Stale, stale};
use crate::diagnosis::statistic::spread::middle_spread;

/// Step of a grid over the short-term noise below which chance repeats can be foretold: with few
/// steps in the noise its law, which a correlation of neighbours or a dither changes, decides.
const SPANNED: f64 = 0.25;

/// What the values themselves say.
#[derive(Debug, Clone, Default)]
pub struct ValueFindings {
    /// Repeats, and where they are.
    pub stale: Option<(Stale, Vec<usize>)>,
    /// Pile-ups, and where they are.
    pub clipping: Vec<(Clipping, Vec<usize>)>,
    /// Grid of the values that is coarser than declared, and not lost in the short-term noise.
    pub coarse: Option<Coarse>,
    /// Step of the grid that all values lie on, where there is one and what is cut off is white noise.
    pub rounded_to: Option<f64>,
    /// Largest size of a value: what its rounding is a share of.
    pub largest: f64,
}

impl ValueFindings {
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
        let coarse = grid.and_then(|step| Coarse::new(step, declared, noise, rms));
        let clipping = clipping(measured, grid, level);
        // On a grid that the noise does not span, repeats are no news.
        let spanned = grid.is_none_or(|step| step < SPANNED * noise);
        let chance = match grid {
            Some(grid) => Chance::on_grid(&increments, grid, noise),
            None => Some(Chance::between(&increments, noise, declared.map(f64::abs))),
        };
        // Samples at a limit are all the same for another reason.
        let is_free = |n: usize| clipping.iter().all(|one| measured[n] != one.level);
        let repeats: Vec<usize> = (1..measured.len())
            .filter(|&n| measured[n] == measured[n - 1] && is_free(n))
            .collect();
        let stale = chance
            .filter(|_| spanned)
            .and_then(|chance| stale(Repeats::new(measured, &repeats), chance, level));
        Self {
            stale: stale.map(|stale| (stale, with_cut_off(repeats, measured, is_free))),
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
            rounded_to: grid.filter(|step| is_white(rms / step)),
            largest: measured
                .iter()
                .filter(|value| value.is_finite())
                .fold(mean.abs(), |most, value| most.max((value + mean).abs())),
        }
    }
}

/// Whether what rounding cuts off is white noise where increments of the rounded values have the root mean square `rms`, over the
/// root of two and in steps. Neighbours of a normal series whose increments have `r` before they are rounded are cut off by
/// numbers with the correlation `6 / pi^2 exp(-4 pi^2 r^2)` (the first harmonic of the rounding: B. Widrow and I. Kollar,
/// Quantization Noise, 2008, chapter 4), and what is cut off adds `1/12` to its square.
fn is_white(rms: f64) -> bool {
    /// Correlation that is none: a choice, it moves the density by 3 %.
    const NONE: f64 = 0.015;
    const PI_SQUARED: f64 = std::f64::consts::PI * std::f64::consts::PI;
    let squared = (rms * rms - 1.0 / 12.0).max(0.0);
    6.0 / PI_SQUARED * (-4.0 * PI_SQUARED * squared).exp() < NONE
}

/// The `places` of repeats, with those that repeat the last sample that was measured before some were missing: the rest of a run
/// that they cut in two.
fn with_cut_off(
    places: Vec<usize>,
    measured: &[f64],
    is_free: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let mut all = places;
    let mut last = f64::NAN;
    for (place, value) in measured.iter().enumerate() {
        let is_cut_off = place > 0 && !measured[place - 1].is_finite();
        if is_cut_off && *value == last && is_free(place) {
            all.push(place);
        }
        if value.is_finite() {
            last = *value;
        }
    }
    all.sort_unstable();
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed as Random;

    #[test]
    fn what_is_cut_off_is_white_where_its_neighbours_do_not_depend_on_it() {
        const SEED: u64 = 11;
        const COUNT: usize = 200_000;
        for (r, is_white_there) in [(0.2, false), (0.26, false), (0.4, true)] {
            let mut normal = Gaussian::new(
                Random {
                    seed: SEED,
                    stream: 0,
                },
                r * f64::sqrt(2.0),
            );
            let mut level = 0.3;
            let rest = (0..COUNT).map(|_| {
                level += normal.draw();
                level - level.round()
            });
            let rest: Vec<f64> = rest.collect();
            let products = rest.windows(2).map(|two| two[0] * two[1]);
            let correlation = 12.0 * products.sum::<f64>() / COUNT as f64;
            let pi_squared = std::f64::consts::PI.powi(2);
            let said = 6.0 / pi_squared * (-4.0 * pi_squared * r * r).exp();
            // Five deviations of a mean of so many, tied over a few; the second harmonic is below a thousandth.
            let sd = 2.0 / (COUNT as f64).sqrt();
            assert!(
                (correlation - said).abs() < 5.0 * sd,
                "{r}: {correlation}, {said}, seed {SEED}"
            );
            assert_eq!(is_white((r * r + 1.0 / 12.0).sqrt()), is_white_there, "{r}");
        }
    }
    use crate::model::random::Seed;

    /// What is made of normal numbers, one after the other.
    fn found(seed: u64, mut make: impl FnMut(f64) -> f64) -> ValueFindings {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let values: Vec<f64> = (0..1 << 15).map(|_| make(noise.draw())).collect();
        ValueFindings::new(None, 2e-4, &values, 0.0)
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
    fn a_run_that_missing_samples_cut_in_two_is_one() {
        let mut count = 0;
        let mut last = 0.0;
        let found = found(5, |z| {
            count += 1;
            // Runs of ten samples, the sixth of which is missing.
            match count % 100 {
                50..60 if count % 10 == 5 => f64::NAN,
                50..60 => last,
                _ => {
                    last = z;
                    z
                }
            }
        });
        let (_, places) = found.stale.expect("repeats, seed 5");
        // Sample number `count` stands at the place `count - 1`.
        let expected =
            (0..1 << 15).filter(|n| (50..60).contains(&((n + 1) % 100)) && (n + 1) % 10 != 5);
        assert!(places.into_iter().eq(expected), "seed 5");
    }

    #[test]
    fn a_grid_decides_from_some_two_deviations_on() {
        for (step, decides) in [(1.0, false), (4.0, true)] {
            let found = found(2, |z| step * (z / step).round());
            let coarse = found.coarse.expect("a grid that nobody declared");
            assert_eq!(coarse, Coarse { step, decides }, "seed 2");
            assert!(found.stale.is_none(), "seed 2, step {step}");
        }
    }

    /// A pulse counter that is read in units of two steps and a half has few values, and a third of its samples
    /// repeat; a file whose numbers were rounded to two grids one after the other has increments that are uneven.
    #[test]
    fn a_counter_of_few_values_repeats_by_chance() {
        for seed in 4..14 {
            let counter = found(seed, |z| (2.5 * (2.2 * z).trunc()).round());
            assert!(counter.stale.is_none(), "seed {seed}: {:?}", counter.stale);
            let twice = found(seed, |z| ((60.0 * z).round() / 1.37).round());
            assert!(twice.stale.is_none(), "seed {seed}: {:?}", twice.stale);
        }
    }

    #[test]
    fn values_that_mostly_repeat_have_the_noise_of_those_that_do_not() {
        let (mut drawn, mut last) = (0, 0.0);
        let found = found(3, |z| {
            drawn += 1;
            if drawn % 4 == 0 {
                last = 0.02 * (z / 0.02).round();
            }
            last
        });
        assert!(found.stale.is_some(), "seed 3");
        assert_eq!(found.coarse, None, "seed 3");
    }
}
