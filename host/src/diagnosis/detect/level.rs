//! The level in time: of what follows a covariate, a settling, a jump and a smooth course, the one that shows most.
//!
//! They take one another's place: what is not explained by the one that is there is explained in part
//! by the others. So they look together, and the largest is taken in first.

use super::{Detector, again, drift, steps, thermal, warmup};
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::axis::profile::Noise;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::room;
use crate::model::steps::KIND as STEPS;

/// Tests of one look: what follows a covariate, settling, jumps.
const TESTS: u32 = 3;

/// Looks in noise as it was fitted.
pub static IN_FITTED_NOISE: Detector = Detector {
    tests: TESTS,
    look: |look| strongest(look, Noise::Fitted),
};

/// Looks in noise whose walk and flicker are fitted anew together with each of the three, and for a smooth course, which
/// is looked for in no other way.
pub static IN_NOISE_ANEW: Detector = Detector {
    tests: TESTS + 1,
    look: |look| strongest(look, Noise::Anew),
};

/// Share of the gain of a smooth course from which what explains that much alone comes first: a choice. A course follows
/// all that is slow at once; what is not smooth of it, or follows a law, would be lost in it.
const PART: f64 = 0.5;

fn strongest(look: &Look<'_>, noise: Noise) -> Result<Vec<Proposal>, NoFit> {
    // Nothing has changed when a round comes to its second look.
    if noise == Noise::Fitted {
        let better = again::proposals(look);
        if !better.is_empty() {
            return Ok(better);
        }
    }
    let thermal = thermal::find(look, noise);
    let settling = warmup::find(look, noise);
    let jump = steps::find(look, noise);
    let size = |z: Option<f64>| z.map_or(0.0, f64::abs);
    let of_thermal = size(thermal.as_ref().map(|found| found.change.z));
    let of_settling = size(settling.as_ref().map(|change| change.z));
    let of_jump = size(jump.map(|jump| jump.z));
    let course = (noise == Noise::Anew).then(|| drift::find(look)).flatten();

    let slow = [
        thermal.as_ref().map(|found| &found.change),
        settling.as_ref(),
    ];
    let gains = slow.into_iter().flatten().map(|change| change.gain_nats);
    let most_nats = gains.fold(0.5 * of_jump * of_jump, f64::max);
    let is_most = course
        .as_ref()
        .is_some_and(|course| course.nats * PART > most_nats);
    let largest = if is_most {
        Vec::new()
    } else if let Some(thermal) =
        thermal.filter(|_| of_thermal >= of_settling && of_thermal >= of_jump)
    {
        thermal::proposal(thermal).into_iter().collect()
    } else if let Some(settling) = settling.filter(|_| of_settling > 0.0 && of_settling >= of_jump)
    {
        warmup::proposal(look, settling).into_iter().collect()
    } else {
        jump.map_or_else(Vec::new, |jump| steps::proposals(look, jump))
    };
    match course {
        Some(course) if !largest.iter().any(|one| is_held(look, one)) => {
            let settling = settling_in_place_of(look, &course)?;
            let proposal = settling.unwrap_or_else(|| drift::proposal(look, course));
            Ok(vec![proposal])
        }
        _ => Ok(largest),
    }
}

/// A settling in place of a smooth course and of the jumps that were found for it, where it explains as much: the jumps had
/// hidden it.
///
/// # Errors
/// [`NoFit`] where the record with the jumps put back cannot be fitted.
fn settling_in_place_of(look: &Look<'_>, course: &drift::Found) -> Result<Option<Proposal>, NoFit> {
    if course.supersedes != [STEPS] {
        return Ok(None);
    }
    let mut axis = look.axis.clone();
    axis.withdraw(STEPS);
    axis.refresh()?;
    let without = Look {
        axis: &axis,
        ..*look
    };
    let settling = warmup::find(&without, Noise::Anew);
    let explained_nats = settling.as_ref().map_or(0.0, |one| one.gain_nats);
    let is_most = drift::find(&without).is_some_and(|one| one.nats * PART > explained_nats);
    let proposal = settling
        .filter(|_| !is_most)
        .and_then(|settling| warmup::proposal(&without, settling));
    Ok(proposal.map(|mut proposal| {
        if let Proposal::Explain(candidate) = &mut proposal {
            candidate.supersedes.push(STEPS);
        }
        proposal
    }))
}

/// Whether the record has room for what is proposed. What shows most and is refused, as a settling that never settles, does not
/// stand in the way of a course.
fn is_held(look: &Look<'_>, proposal: &Proposal) -> bool {
    match proposal {
        Proposal::Explain(candidate) => room::holds(look.axis, candidate),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::record::reading::Reading;
    use crate::diagnosis::record::wave::Wave;
    use crate::model::kind::Kind;

    /// What is named first of a record that has all three: gain, amplitude of the settling, and height of the
    /// jump.
    fn first(seed: u64, [gain, amplitude, height]: [f64; 3]) -> Kind {
        let mut values = noise(seed);
        let covariate = trial::covariate(values.len());
        for (value, covariate) in values.iter_mut().zip(&covariate) {
            *value += gain * covariate;
        }
        let middle = values.len() / 2;
        trial::add(&mut values, &trial::settling(amplitude, 20.0));
        trial::add(&mut values, &Wave::Steps(vec![trial::jump(middle, height)]));
        let mut trial = Trial::new(values);
        trial.covariate = Some(Reading::exact(covariate));
        let found = trial::candidate(trial.ask(&IN_NOISE_ANEW));
        found
            .unwrap_or_else(|| panic!("seed {seed}: nothing"))
            .effect
            .kind
    }

    #[test]
    fn the_largest_of_three_is_named_first() {
        use crate::model::{thermal, warmup};
        // Beside a jump; beside a jump; beside both others, half as plain.
        assert_eq!(first(0, [2.0, 4.0, 1.0]), thermal::KIND);
        assert_eq!(first(0, [1.0, 12.0, 1.0]), warmup::KIND);
        assert_eq!(first(0, [2.0, 8.0, 2.0]), STEPS);
    }

    #[test]
    fn a_settling_takes_the_place_of_a_course_for_jumps_and_of_no_other() {
        use crate::model::warmup;
        let in_place = |slow: &dyn Fn(f64) -> f64, supersedes: &[Kind]| {
            let mut values = noise(2);
            let length = values.len() as f64;
            let both = values.iter_mut().enumerate();
            both.for_each(|(n, one)| *one += slow(n as f64 / length));
            let trial = Trial::new(values);
            let proposed = trial.look(|look| {
                let mut course = drift::find(look).expect("a course, seed 2");
                course.supersedes = supersedes.to_vec();
                settling_in_place_of(look, &course)
            });
            let proposed = proposed.expect("a fit, seed 2");
            trial::candidate(proposed.into_iter().collect())
        };
        let settling = |x: f64| 4.0 * (-8.0 * x).exp();
        let named = in_place(&settling, &[STEPS]).expect("a settling, seed 2");
        assert_eq!(
            (named.effect.kind, named.supersedes),
            (warmup::KIND, vec![STEPS])
        );
        assert!(in_place(&settling, &[]).is_none(), "seed 2: for nothing");
        let swing = |x: f64| 30.0 * (3.0 * std::f64::consts::PI * x).cos();
        assert!(in_place(&swing, &[STEPS]).is_none(), "seed 2: no settling");
    }

    #[test]
    fn what_a_record_has_no_room_for_does_not_stand_in_the_way_of_a_course() {
        use crate::model::drift::KIND;
        let mut values = noise(1);
        let half = 0.5 * values.len() as f64;
        // A parabola and its bend the other way: an exponential that follows it never settles.
        for (n, value) in values.iter_mut().enumerate() {
            let at = n as f64 / half - 1.0;
            *value += 200.0 * (at * at + 0.2 * at.powi(3));
        }
        let trial = Trial::new(values);
        let refused = trial.look(|look| {
            let settling = warmup::find(look, Noise::Anew)?;
            let proposal = warmup::proposal(look, settling)?;
            Some(is_held(look, &proposal))
        });
        assert_eq!(refused, Some(false), "seed 1: nothing to refuse");
        let found = trial::candidate(trial.ask(&IN_NOISE_ANEW)).expect("a course, seed 1");
        assert_eq!(found.effect.kind, KIND, "seed 1");
    }
}
