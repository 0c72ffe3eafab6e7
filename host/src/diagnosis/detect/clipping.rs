//! Clipping: samples pile up at an extreme value.

use super::Detector;
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::{Replaced, Side, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::clipping::KIND;

/// Looks for pile-ups at both extremes.
pub static DETECTOR: Detector = Detector { tests: 1, look };

/// Share of the record at an extreme from which that is no event: a choice. One that lasts as long is most of the record.
const MUCH: f64 = 0.1;

/// The same ahead of events, where much of the record is at an extreme: between its stays there, it is not loud. The test is that of
/// [`DETECTOR`].
pub static OF_MUCH: Detector = Detector {
    tests: 0,
    look: |of| {
        let at_limits = of.context.values.clipping.iter();
        let count: usize = at_limits.map(|(_, places)| places.len()).sum();
        if (count as f64) < MUCH * of.axis.residual.len() as f64 {
            return Ok(Vec::new());
        }
        look(of)
    },
};

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let values = look.context.values;
    let known = look.axis.explanations().iter();
    // One side after the other, the second in the noise that is left without the first.
    let known = known.filter(|one| one.kind() == KIND).count();
    let Some((clipping, places)) = values.clipping.get(known) else {
        return Ok(Vec::new());
    };
    // Known to the rounding of the mean that was taken out and put back.
    let slack = 4.0 * f64::EPSILON * values.largest;
    let level = Value::normal(clipping.level, slack);
    let side = match clipping.side > 0.0 {
        true => Side::Above,
        false => Side::Below,
    };
    let replaced = Replaced::bridged(&look.axis.residual.values(), places, side);
    let candidate = Candidate::new(
        Estimate::new(KIND, [level, Value::exact(clipping.side)]),
        clipping.p_value,
        1.0,
        Change::Waves(vec![Wave::Replaced(replaced)]),
    );
    Ok(vec![Proposal::Explain(Box::new(candidate))])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};

    #[test]
    fn much_at_a_limit_is_no_event_and_little_may_be_one() {
        for (seed, limit, is_much) in [(1, 0.8, true), (2, 2.5, false)] {
            let clipped = noise(seed).into_iter().map(|value| value.min(limit));
            let trial = Trial::new(clipped.collect());
            let ahead = trial::kinds(&trial.ask(&OF_MUCH));
            assert_eq!(ahead == [KIND], is_much, "seed {seed}: {ahead:?}");
            assert_eq!(trial::kinds(&trial.ask(&DETECTOR)), [KIND], "seed {seed}");
        }
    }

    #[test]
    fn one_side_is_named_after_the_other() {
        let clipped = noise(0).into_iter().map(|value| value.clamp(-1.5, 2.0));
        let mut trial = Trial::new(clipped.collect());
        let mut sides = Vec::new();
        for _ in 0..2 {
            let found = trial::candidate(trial.ask(&DETECTOR)).expect("a side that is left");
            sides.push(found.effect.plain());
            trial.accept(found);
        }
        sides.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert_eq!(sides, [[-1.5, -1.0], [2.0, 1.0]], "seed 0");
        assert!(trial.ask(&DETECTOR).is_empty(), "seed 0: a third side");
    }
}
