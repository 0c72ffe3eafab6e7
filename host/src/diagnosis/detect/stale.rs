//! Stale: samples that repeat the one before, more often than chance has it.

use super::Detector;
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::{Replaced, Side, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::stale::KIND;

/// Looks for samples that repeat the one before.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let candidate = look.context.values.stale.as_ref();
    let candidate = candidate
        .filter(|_| !look.axis.has(KIND))
        .map(|(stale, places)| {
            let replaced = Replaced::bridged(&look.axis.residual.values(), places, Side::Any);
            let share = Value::normal(stale.share, stale.share_sd);
            let run_samples = stale.run_samples.map(|(run, sd)| Value::normal(run, sd));
            Proposal::Explain(Box::new(Candidate::new(
                Estimate::new(KIND, std::iter::once(share).chain(run_samples)),
                stale.p_value,
                1.0,
                Change::Waves(vec![Wave::Replaced(replaced)]),
            )))
        });
    Ok(candidate.into_iter().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};

    #[test]
    fn repeats_are_replaced_once() {
        let mut values = noise(0);
        for n in (500..values.len()).step_by(701) {
            values[n] = values[n - 1];
        }
        let mut trial = Trial::new(values);
        let found =
            trial::candidate(trial.ask(&DETECTOR)).expect("no two values are the same by chance");
        assert_eq!(found.effect.kind, KIND, "seed 0");
        trial.accept(found);
        assert!(trial.ask(&DETECTOR).is_empty(), "seed 0: again");
        assert!(
            Trial::new(noise(0)).ask(&DETECTOR).is_empty(),
            "seed 0: no repeats"
        );
    }
}
