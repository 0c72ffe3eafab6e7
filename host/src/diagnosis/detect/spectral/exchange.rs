//! Laws that another one takes the place of, once there are others beside them.
//!
//! The first law is the one that explains most by itself, and may be none of two that are there: noise behind a slow lag and a
//! pole comes first as one pole between them. What is missing then is sought beside the wrong law, and never found. So,
//! where nothing more is to be added, each law is left out and all kinds are tried in its place.

use rayon::prelude::*;

use super::{is_line, worth};
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::Detector;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::laws;
use crate::diagnosis::laws::search::{self, Fitted, Found, Starts};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Rival;
use crate::model::catalogue::CATALOGUE;
use crate::model::telegraph;

/// Size of the first move of all laws, as a logarithm, once one is in another's place: as when anything else has changed.
const STEP: f64 = 0.05;

/// Looks for the law that is worth most in another's place. The tests are those of the laws.
pub static DETECTOR: Detector = Detector { tests: 0, look };

/// Laws that may be in the place of another.
struct Exchange {
    /// Number of the law that is left out.
    number: usize,
    /// Gain of the best with all others moved to it, parameters paid for, nats.
    nats: f64,
    /// The laws, the one that is worth most first.
    found: Vec<Found>,
}

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let axis = look.axis;
    if axis.laws.is_empty() {
        return Ok(Vec::new());
    }
    let starts = axis.starts().ok_or(NoFit)?;
    let explanations = axis.explanations().iter();
    let laws = explanations.filter(|one| one.law().is_some()).enumerate();
    // Two levels are known by more than their spectrum.
    let laws = laws.filter(|(_, one)| one.kind() != telegraph::KIND);
    let exchanges = laws.filter_map(|(number, _)| instead_of(look, &starts, number));
    let best = exchanges.max_by(|a, b| a.nats.total_cmp(&b.nats));
    let is_better = |one: &Exchange| (-one.nats).exp() < look.level();
    Ok(best.filter(is_better).map_or_else(Vec::new, |best| {
        vec![
            Proposal::WithdrawLaw(best.number),
            Proposal::Explain(Box::new(candidate(best.found))),
        ]
    }))
}

/// The law that is worth most, with the others as rivals.
fn candidate(mut found: Vec<Found>) -> Candidate {
    let first = found.remove(0);
    let rivals = found.iter().map(|one| Rival {
        effect: one.law.effect,
        log_odds: worth(&first) - worth(one),
    });
    let effect = Estimate::of_law(first.law.effect);
    let freedom = first.law.values.len() as f64;
    Candidate {
        rivals: rivals.collect(),
        ..Candidate::new(effect, first.p_value, freedom, Change::Law(first.law))
    }
}

/// What may be in the place of a law.
fn instead_of(look: &Look<'_>, starts: &Starts, number: usize) -> Option<Exchange> {
    let axis = look.axis;
    let mut others = axis.laws.clone();
    let own = others.remove(number);
    let fit = laws::fit(&axis.bins, &axis.data, &others)?;
    let present = Fitted {
        bins: &axis.bins,
        data: &axis.data,
        laws: &others,
        fit: &fit,
    };
    let kinds = CATALOGUE.par_iter();
    let kinds = kinds.filter(|kind| **kind != own.effect && look.is_open(**kind));
    let found = kinds.filter_map(|&kind| search::search(present, starts, kind));
    let mut found: Vec<Found> = found.filter(|one| one.p_value < look.level()).collect();
    found.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    let first = found.first().filter(|one| !is_line(look, one))?;
    let cost = first.law.values.len() as f64 - own.values.len() as f64;
    let mut all = others.clone();
    all.push(first.law.clone());
    let fit = search::polish(&axis.bins, &axis.data, &mut all, 0, STEP)?;
    Some(Exchange {
        number,
        nats: fit.log_likelihood - axis.fit.log_likelihood - cost,
        found,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::laws::Law;
    use crate::model::kind::Kind;
    use crate::model::{markov, resonance};

    /// What is proposed of noise with a band about 20 Hz that is taken for a law of this kind.
    fn proposed(seed: u64, kind: Kind, values: &[f64]) -> Vec<Proposal> {
        let mut record = noise(seed);
        trial::add_band(&mut record, seed, 1.0, |_| 1.0);
        let mut trial = Trial::new(record);
        let law = Law {
            effect: kind,
            values: values.to_vec(),
        };
        trial.know(kind, [1.0], Change::Law(law));
        trial.ask(&DETECTOR)
    }

    #[test]
    fn a_law_that_another_explains_better_gives_its_place() {
        for seed in 40..43 {
            let proposals = proposed(seed, markov::KIND, &[1.0, 0.01]);
            let [Proposal::WithdrawLaw(0), ..] = proposals[..] else {
                panic!("seed {seed}: it stays");
            };
            assert_eq!(trial::kinds(&proposals), [resonance::KIND], "seed {seed}");
            let right = proposed(seed, resonance::KIND, &[20.0, 3.0, 1.0]);
            assert!(right.is_empty(), "seed {seed}: it is right");
        }
    }
}
