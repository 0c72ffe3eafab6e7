//! Coarse steps (the effect `quantisation`): all values lie on a grid that nobody declared.

use super::Detector;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::values::grid::Coarse;
use crate::model::rounding::KIND;

/// Looks for a grid that all values lie on.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let values = look.context.values;
    let candidate =
        values
            .coarse
            .filter(|_| !look.axis.has(KIND))
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
}
