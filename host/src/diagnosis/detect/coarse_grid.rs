//! Coarse steps (the effect `quantisation`): all values lie on a grid that nobody declared.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::Detector;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::values::grid::Coarse;
use crate::fit::likelihood::Data;
use crate::model::rounding::{KIND, Rounding};

/// Looks for a grid that all values lie on.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let values = look.context.values;
    let candidate = values
        .coarse
        .filter(|_| !look.axis.has(KIND))
        .filter(|coarse| !is_quieter(look.axis, coarse.step, look.level()))
        .map(|Coarse { step, decides }| {
            // A difference of two values, each known to its rounding. Thousands of values on a grid
            // that nobody laid have a probability below what a number can hold.
            let step = Value::normal(step, 4.0 * f64::EPSILON * values.largest);
            let effect = Estimate::new(KIND, [step]);
            Proposal::Explain(Box::new(Candidate::new(
                effect,
                0.0,
                1.0,
                Change::Grid { decides },
            )))
        });
    Ok(candidate.into_iter().collect())
}

/// Density of the white noise that rounding to a `step` adds to an axis behind all filters; zero where the noise is quieter than
/// that, by less chance than `level`.
pub fn floor(axis: &AxisState, step: f64, level: f64) -> f64 {
    if is_quieter(axis, step, level) {
        return 0.0;
    }
    Rounding { step }.density(axis.rate_hz)
}

/// Whether the spectrum of an axis is below what rounding to a `step` leaves, by less chance than `level`: what is cut off
/// carries over to the next value then, as in a counter of pulses, and is the Q of the five terms. Of noise that spans
/// less than a step nothing is said: what its rounding leaves depends on the level.
fn is_quieter(axis: &AxisState, step: f64, level: f64) -> bool {
    if short_term(axis) < 0.5 * step {
        return false;
    }
    let floor = Rounding { step }.density(axis.rate_hz);
    let Data { f_hz, psd, dof, .. } = &axis.data;
    let mut from = 0;
    let mut octaves = Vec::new();
    while from < psd.len() {
        let to = f_hz
            .partition_point(|one| *one < 2.0 * f_hz[from])
            .max(from + 1);
        let freedom: f64 = dof[from..to].iter().sum();
        let sum: f64 = (from..to).map(|bin| dof[bin] * psd[bin] / floor).sum();
        octaves.push((sum, freedom));
        from = to;
    }
    let count = octaves.len() as f64;
    let mut quieter = octaves.into_iter().filter(|(_, freedom)| *freedom >= 1.0);
    quieter.any(|(sum, freedom)| {
        let below = ChiSquared::new(freedom).map_or(1.0, |law| law.cdf(sum));
        p_value::searched(below, count) < level
    })
}

/// Deviation of noise by its increments.
fn short_term(axis: &AxisState) -> f64 {
    let values = axis.residual.seen();
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    let (sum, count) = steps
        .filter(|square| square.is_finite())
        .fold((0.0, 0.0), |(sum, count), square| {
            (sum + square, count + 1.0)
        });
    (0.5 * sum / f64::max(count, 1.0)).sqrt()
}

/// Whether the grid of an axis decides how strong its noise looks: what changes its strength in time is no
/// burst then.
pub fn decides(axis: &AxisState) -> bool {
    let mut changes = axis.explanations().iter().map(|one| &one.change);
    changes.any(|change| *change == Change::Grid { decides: true })
}

/// Variance that noise must have to stand out of what rounding leaves; zero where the noise spans many steps. Where it spans few,
/// what rounding leaves is not white, goes with the level, and has some law or other: half a step at most.
pub fn least_variance(axis: &AxisState) -> f64 {
    let grid = axis.explanation(KIND).filter(|_| decides(axis));
    grid.map_or(0.0, |grid| {
        (0.5 * Rounding::of(&grid.effect.plain()).step).powi(2)
    })
}

/// By how much at most the power of an axis may change as its level moves between the values of its grid; 1 where it has
/// none. Normal noise of `r` steps that is rounded has the power `r^2 + 1/12` in steps squared, and, as the level goes from a value to
/// the next, a cosine of the size `(1 / pi^2 + 4 r^2) exp(-2 pi^2 r^2)` about it (the first term of the Fourier series of
/// its rounding: B. Widrow and I. Kollar, Quantization Noise, 2008, chapter 4).
pub fn most_power(axis: &AxisState) -> f64 {
    let Some(grid) = axis.explanation(KIND) else {
        return 1.0;
    };
    let step = Rounding::of(&grid.effect.plain()).step;
    // What is measured is rounded already.
    let measured = about_level(axis) / (step * step);
    cosine_of_rounding((measured - 1.0 / 12.0).max(0.0)).powi(2)
}

/// Variance of noise about a level that moves slowly: of what is next to each other.
fn about_level(axis: &AxisState) -> f64 {
    /// Samples whose mean is their level: a choice, a sixteenth of the variance stays in it.
    const NEXT: usize = 16;
    let values = axis.residual.seen();
    let variances = values.chunks_exact(NEXT).map(|some| {
        let mean = some.iter().sum::<f64>() / NEXT as f64;
        some.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (NEXT - 1) as f64
    });
    let there = variances.filter(|one| one.is_finite());
    let (sum, count) = there.fold((0.0, 0.0), |(sum, count), one| (sum + one, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// One and the share of the power of noise with this square, in steps, that goes with the level.
fn cosine_of_rounding(square: f64) -> f64 {
    const PI_SQUARED: f64 = std::f64::consts::PI * std::f64::consts::PI;
    let cosine = (1.0 / PI_SQUARED + 4.0 * square) * (-2.0 * PI_SQUARED * square).exp();
    1.0 + cosine / (square + 1.0 / 12.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_of_what_is_rounded_goes_with_the_level_as_the_first_harmonic_says() {
        let seed = 3;
        let mut normal = crate::diagnosis::trial::numbers(seed, 0);
        const COUNT: usize = 200_000;
        for r in [0.4, 0.5, 0.6_f64] {
            let mut power = |level: f64| {
                let rounded: Vec<f64> = (0..COUNT)
                    .map(|_| (level + r * normal.draw()).round())
                    .collect();
                let mean = rounded.iter().sum::<f64>() / COUNT as f64;
                rounded.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / COUNT as f64
            };
            let (between, at) = (power(0.5), power(0.0));
            let said = cosine_of_rounding(r * r) - 1.0;
            let found = (between - at) / (between + at);
            // Two mean squares, five deviations; the second harmonic is a hundredth.
            let sd = (1.0 / COUNT as f64).sqrt();
            assert!(
                (found - said).abs() < 5.0 * sd + 0.01 * said,
                "{r}: {found}, {said}, seed {seed}"
            );
        }
        assert!(cosine_of_rounding(1.0) < 1.0 + 1e-6);
    }
    use crate::diagnosis::detect::trial::{self, Trial, noise};

    #[test]
    fn a_grid_is_named_once_and_decides_where_the_noise_spans_few_of_its_steps() {
        for (step, is_decisive) in [(1.0, false), (4.0, true)] {
            let rounded = noise(0)
                .into_iter()
                .map(|value| step * (value / step).round());
            let mut trial = Trial::new(rounded.collect());
            let found = trial::candidate(trial.ask(&DETECTOR)).expect("a grid");
            assert_eq!(found.effect.plain(), [step], "seed 0");
            trial.accept(found);
            assert_eq!(decides(&trial.axis), is_decisive, "seed 0, step {step}");
            assert!(
                trial.ask(&DETECTOR).is_empty(),
                "seed 0, step {step}: again"
            );
        }
        assert!(
            Trial::new(noise(0)).ask(&DETECTOR).is_empty(),
            "seed 0: no grid"
        );
    }

    #[test]
    fn noise_beside_coarse_steps_is_louder_than_half_of_one() {
        for (step, least) in [(1.0, 0.0), (4.0, 4.0)] {
            let rounded = noise(2)
                .into_iter()
                .map(|value| step * (value / step).round());
            let mut trial = Trial::new(rounded.collect());
            let found = trial::candidate(trial.ask(&DETECTOR)).expect("a grid");
            trial.accept(found);
            assert_eq!(least_variance(&trial.axis), least, "seed 2, step {step}");
        }
    }

    /// A counter of pulses keeps what it has not counted for the next reading: at low frequencies nothing but noise of
    /// deviation 1 is there, an eighth of what rounding to tens would leave; a dither makes it span some steps.
    #[test]
    fn a_grid_whose_remainder_carries_over_is_no_rounding() {
        let mut carried = 0.0;
        let counted = (0..).zip(noise(1)).map(|(n, value)| {
            let value = value + 20.0 * (1.95 * f64::from(n)).sin();
            let whole = ((value + carried) / 10.0).round();
            carried += value - 10.0 * whole;
            10.0 * whole
        });
        let trial = Trial::new(counted.collect());
        assert!(trial.ask(&DETECTOR).is_empty(), "seed 1");
    }
}
