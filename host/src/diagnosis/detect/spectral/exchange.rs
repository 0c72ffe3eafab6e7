//! Laws that another one takes the place of, once there are others beside them.
//!
//! The first law is the one that explains most by itself, and may be none of two that are there: noise behind a slow lag and a
//! pole comes first as one pole between them. What is missing then is sought beside the wrong law, and never found. So,
//! where nothing more is to be added, each law is left out and all kinds are tried in its place. What does not take it is its
//! rival, by the odds beside all that was found.

use rayon::prelude::*;

use super::{cost, is_beyond_rounding, is_line};
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::Detector;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::laws::search::{self, Fitted, Found, Starts};
use crate::diagnosis::laws::{self, Law};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::rival::{Rival, is_decided};
use crate::model::catalogue::CATALOGUE;
use crate::model::kind::Kind;
use crate::model::telegraph;

/// Size of the first move of all laws, as a logarithm, once one is in another's place: as when anything else has changed.
const STEP: f64 = 0.05;

/// Looks for the law that is worth most in another's place. The tests are those of the laws.
pub static DETECTOR: Detector = Detector { tests: 0, look };

/// A law in the place of another.
struct Instead {
    /// Number of the law that is left out.
    number: usize,
    /// The one in its place, with all others moved to it, and its gain over nothing there.
    found: Found,
    /// Log-likelihood less what all laws cost, nats.
    worth: f64,
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
    let numbers = laws.map(|(number, _)| number);
    let mut found: Vec<Instead> = numbers
        .clone()
        .flat_map(|number| instead_of(look, &starts, number))
        .collect();
    found.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    let now = axis.fit.log_likelihood - costs(axis.rate_hz, &axis.laws);
    if !found.first().is_some_and(|one| is_decided(one.worth - now)) {
        let compare = |number| Proposal::Compare(number, rivals(&found, number, now));
        return Ok(numbers.map(compare).collect());
    }
    let best = found.remove(0);
    let rivals = rivals(&found, best.number, best.worth);
    let Found { law, p_value, .. } = best.found;
    let freedom = law.freedom();
    let effect = Estimate::of_law(law.effect);
    let candidate = Candidate {
        rivals,
        ..Candidate::new(effect, p_value, freedom, Change::Law(law))
    };
    Ok(vec![
        Proposal::WithdrawLaw(best.number),
        Proposal::Explain(Box::new(candidate)),
    ])
}

/// What else may be in the place of a law, where what is there is worth so much.
fn rivals(found: &[Instead], number: usize, worth: f64) -> Vec<Rival> {
    let others = found.iter().filter(|one| one.number == number);
    let rivals = others.map(|one| Rival {
        effect: one.found.law.effect,
        log_odds: worth - one.worth,
    });
    rivals.collect()
}

/// Nats that all these laws cost.
fn costs(rate_hz: f64, laws: &[Law]) -> f64 {
    laws.iter().map(|law| cost(rate_hz, law)).sum()
}

/// What may be in the place of a law.
fn instead_of(look: &Look<'_>, starts: &Starts, number: usize) -> Vec<Instead> {
    let axis = look.axis;
    let mut others = axis.laws.clone();
    let own = others.remove(number);
    let Some(fit) = laws::fit(&axis.bins, &axis.data, &others) else {
        return Vec::new();
    };
    let present = Fitted {
        bins: &axis.bins,
        data: &axis.data,
        laws: &others,
        fit: &fit,
    };
    let kinds = CATALOGUE.par_iter();
    // Of two filters of a kind one would be said to gain nothing.
    let is_twice =
        |kind: Kind| kind.size().is_none() && others.iter().any(|one| one.effect == kind);
    let kinds =
        kinds.filter(|kind| **kind != own.effect && !is_twice(**kind) && look.is_open(**kind));
    let found = kinds.filter_map(|&kind| {
        let found = search::search(present, starts, kind)?;
        let is_one = found.p_value < look.level() && is_beyond_rounding(axis, &found);
        if !is_one || is_line(look, &found) {
            return None;
        }
        let mut all = others.clone();
        all.push(found.law.clone());
        let fit = search::polish(&axis.bins, &axis.data, &mut all, 0, STEP)?;
        Some(Instead {
            number,
            worth: fit.log_likelihood - costs(axis.rate_hz, &all),
            found: Found {
                law: all.pop()?,
                ..found
            },
        })
    });
    found.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::laws::Law;
    use crate::model::{averaging, markov, powerlaw, resonance};

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
    fn what_is_as_narrow_as_a_line_is_asked_for_its_own_size() {
        // The law in whose place it would be has a size too, behind those of the five terms.
        for seed in 50..53 {
            let mut record = noise(seed);
            trial::add(&mut record, &trial::line(20.0, -3.0));
            let mut trial = Trial::new(record);
            let law = Law {
                effect: markov::KIND,
                values: vec![1.0, 0.01],
            };
            trial.know(markov::KIND, [1.0], Change::Law(law));
            let proposed = trial.ask(&DETECTOR);
            assert!(!proposed.is_empty(), "seed {seed}: it stays");
        }
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
            let [Proposal::Compare(0, rivals)] = &right[..] else {
                panic!("seed {seed}: it is right, {right:?}");
            };
            let is_less = |rival: &Rival| rival.log_odds > 10.0;
            assert!(!rivals.is_empty(), "seed {seed}: it has rivals");
            assert!(rivals.iter().all(is_less), "seed {seed}: {rivals:?}");
        }
    }

    #[test]
    fn what_a_law_is_told_from_is_remembered() {
        let mut record = noise(43);
        trial::add_band(&mut record, 43, 1.0, |_| 1.0);
        let mut trial = Trial::new(record);
        let law = |kind: Kind, values: &[f64]| Law {
            effect: kind,
            values: values.to_vec(),
        };
        let bell = law(resonance::KIND, &[20.0, 3.0, 1.0]);
        trial.know(resonance::KIND, [1.0], Change::Law(bell));
        let rival = |effect, log_odds| Rival { effect, log_odds };
        let is_told = |trial: &Trial, expected: &[(Kind, f64)]| {
            let rivals = trial.axis.explanations()[0].rivals.iter();
            let rivals: Vec<(Kind, f64)> = rivals.map(|one| (one.effect, one.log_odds)).collect();
            assert_eq!(rivals, expected);
        };
        // What two levels are told by is more than a spectrum.
        trial.axis.set_rivals(0, vec![rival(telegraph::KIND, 7.0)]);
        trial.axis.set_rivals(0, vec![rival(markov::KIND, 9.0)]);
        is_told(&trial, &[(telegraph::KIND, 7.0), (markov::KIND, 9.0)]);
        trial.axis.set_rivals(0, vec![rival(powerlaw::KIND, 5.0)]);
        is_told(&trial, &[(powerlaw::KIND, 5.0), (telegraph::KIND, 7.0)]);
    }

    #[test]
    fn of_two_filters_of_a_kind_none_takes_the_place_of_another_law() {
        for seed in 44..47 {
            let record = trial::averaged(trial::averaged(noise(seed), 9.0), 4.0);
            let mut trial = Trial::new(record);
            let mean = |kind: Kind, values: &[f64]| Law {
                effect: kind,
                values: values.to_vec(),
            };
            let nine = mean(averaging::KIND, &[0.09]);
            trial.know(averaging::KIND, [1.0], Change::Law(nine));
            let bell = mean(resonance::KIND, &[20.0, 30.0, 1.0]);
            trial.know(resonance::KIND, [1.0], Change::Law(bell));
            let instead = trial.look(|look| {
                let starts = look.axis.starts().expect("starts");
                instead_of(look, &starts, 1)
            });
            let kinds: Vec<Kind> = instead.iter().map(|one| one.found.law.effect).collect();
            assert!(!kinds.is_empty(), "seed {seed}: nothing in its place");
            assert!(!kinds.contains(&averaging::KIND), "seed {seed}: {kinds:?}");
        }
    }
}
