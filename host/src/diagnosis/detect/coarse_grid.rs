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

#[cfg(test)]
mod tests {
    use super::*;
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
