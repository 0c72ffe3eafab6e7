//! Slow changes that have a name, measured again.
//!
//! A settling is first measured in noise whose walk was raised by it: its time constant is then known less well than the
//! record knows it, and what that leaves of a strong one looks like a drift. So it is put back and measured in the noise that
//! is left now, until that moves it no more; and jumps likewise.

use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::{LEAST_GAIN, MeasuredAgain, put_back};
use crate::diagnosis::detect::{steps, thermal, warmup};
use crate::diagnosis::explanation::Explanation;
use crate::model::{self, kind::Kind};

/// What is to be done about slow changes that are known, where they are known better now.
pub fn proposals(look: &Look<'_>) -> Vec<Proposal> {
    let settlings = warmup::together::proposals(look);
    if !settlings.is_empty() {
        return settlings;
    }
    let settling = again(look, model::warmup::KIND, warmup::measured_again);
    let better = settling.or_else(|| again(look, model::thermal::KIND, thermal::measured_again));
    let better = better.or_else(|| steps::measured_again(look));
    better.into_iter().collect()
}

fn again(
    look: &Look<'_>,
    kind: Kind,
    measured: fn(&Look<'_>, &[f64], &Explanation) -> Option<MeasuredAgain>,
) -> Option<Proposal> {
    let place = look.place_of(kind)?;
    let known = &look.axis.explanations()[place];
    let values = put_back(look.axis, known.waves());
    let measured = measured(look, &values, known)?;
    let Proposal::Explain(mut candidate) = measured.proposal else {
        return None;
    };
    let is_better = measured.gained_nats > LEAST_GAIN || measured.absorbs_more;
    is_better.then(|| {
        candidate.amends = Some(place);
        candidate.p_value = known.p_value;
        Proposal::Explain(candidate)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::explanation::Change;
    use crate::model::warmup::KIND;

    const AMPLITUDE: f64 = 200.0;
    const TIME_S: f64 = 30.0;

    /// A settling that is known with these numbers.
    fn known(seed: u64, amplitude: f64, time_s: f64) -> Trial {
        let mut values = noise(seed);
        trial::add(&mut values, &trial::settling(AMPLITUDE, TIME_S));
        let mut trial = Trial::new(values);
        let change = Change::Waves(vec![trial::settling(amplitude, time_s)]);
        trial.know(KIND, [amplitude, time_s], change);
        trial
    }

    #[test]
    fn a_settling_that_is_known_badly_is_measured_again_until_it_is_known_well() {
        let seed = 20;
        let mut trial = known(seed, 1.01 * AMPLITUDE, 0.99 * TIME_S);
        let again = |trial: &Trial| trial::candidate(trial.look(proposals));
        let mut rounds = 0;
        while let Some(better) = again(&trial) {
            assert_eq!(better.amends, Some(0), "seed {seed}");
            trial.accept(better);
            rounds += 1;
            assert!(rounds < 5, "seed {seed}: it does not settle");
        }
        assert!(rounds > 0, "seed {seed}: not measured again");
        let [amplitude, time_s] = trial.axis.explanations()[0].effect.plain()[..] else {
            panic!("seed {seed}: two numbers");
        };
        // Of the root of 3000 samples within the first time constant the time is known to a ten-thousandth.
        assert!(
            (amplitude / AMPLITUDE).ln().abs() < 1e-3,
            "seed {seed}: {amplitude}"
        );
        assert!(
            (time_s / TIME_S).ln().abs() < 1e-3,
            "seed {seed}: {time_s} s"
        );
    }

    #[test]
    fn where_none_is_known_there_is_nothing_to_measure() {
        let trial = Trial::new(noise(21));
        assert!(trial.look(proposals).is_empty(), "seed 21");
    }
}
