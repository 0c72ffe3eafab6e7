//! Effects as findings, and as a model file has them.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::describe::ahead::{ahead_in, ahead_of};
use crate::diagnosis::describe::coefficients::coefficients_of;
use crate::diagnosis::explanation::{Explanation, Snapshot};
use crate::diagnosis::laws;
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::{Finding, Gain};
use crate::fit::likelihood::Fit;
use crate::model::axis::{ModelAxis, ModelEffect};
use crate::model::effect::Part;
use crate::model::rounding::{self, Rounding};
use crate::model::{PerCoefficient, unnamed};

/// Findings as a model file has them, where data can be made of them, and what else the `noise` has, without a name or
/// because the values are written so, in the order in which they act: a sample is repeated behind all filters, whatever
/// was found first. A harmonic that was not found is zero there.
pub fn all_effects(findings: &[Finding], noise: &ModelAxis) -> Vec<ModelEffect> {
    let effect =
        |finding: &Finding| ModelEffect::of(finding.effect, &finding.estimate.plain()).ok();
    let is_found = |kind| findings.iter().any(|one| one.effect == kind);
    let is_silent = |kind| kind == unnamed::KIND || kind == rounding::KIND && !is_found(kind);
    let silent = noise.effects.iter();
    let silent = silent.filter(|one| is_silent(one.kind())).cloned();
    let stage = |one: &ModelEffect| match one.part() {
        Part::Distortion(distortion) => Some(distortion.stage()),
        Part::Term(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => None,
    };
    let mut all: Vec<ModelEffect> = findings.iter().filter_map(effect).chain(silent).collect();
    all.sort_by_key(stage);
    all
}

/// The laws of a snapshot with the sizes of a fit that has them, its tones ahead of those that filter, and the rounding behind
/// them.
pub fn law_effects(bins: &SpectralBins, snapshot: &Snapshot, fit: &Fit) -> Vec<ModelEffect> {
    let sized = |which: usize| {
        let values = laws::sized(bins, &snapshot.laws, which, fit);
        ModelEffect::of(snapshot.laws[which].effect, &values).ok()
    };
    let measured = |one: &Estimate| {
        let ahead = ahead_of(&snapshot.laws, bins.rate_hz(), one);
        ModelEffect::of(one.kind, &ahead.plain()).ok()
    };
    let laws = (0..snapshot.laws.len()).filter_map(sized);
    let floor = Some(laws::floor(bins, &snapshot.laws)).filter(|floor| *floor > 0.0);
    let step = floor.map(|floor| Rounding::of_density(floor, bins.rate_hz()).step);
    let rounding = step.and_then(|step| ModelEffect::of(rounding::KIND, &[step]).ok());
    laws.chain(snapshot.tones.iter().filter_map(measured))
        .chain(rounding)
        .collect()
}

/// An explanation of an axis with its gains, as it is reported.
pub fn finding(axis: &AxisState, one: &Explanation, gain: Gain) -> Finding {
    let effect = ahead_in(axis, &one.effect);
    Finding {
        rivals: one.rivals.clone(),
        gain,
        without: PerCoefficient::from_fn(|letter| coefficients_of(&one.before).get(letter).value),
        ..Finding::new(&effect, one.p_value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::result::value::Value;
    use crate::model::whole::Model;
    use crate::model::{burst, rolloff, rounding, sinusoid, stale};

    #[test]
    fn what_was_read_twice_passed_the_filters_first() {
        let found = |kind, values: &[f64]| {
            let values = values.iter().copied().map(Value::told);
            Finding::new(&Estimate::new(kind, values), 0.0)
        };
        let findings = [
            found(stale::KIND, &[0.1]),
            found(rounding::KIND, &[1e-3]),
            found(rolloff::KIND, &[10.0]),
            found(burst::KIND, &[1.0, 2.0, 3.0]),
            found(sinusoid::KIND, &[50.0, 1.0]),
        ];
        let noise = Model::published(None).axes.remove(0);
        let all = all_effects(&findings, &noise);
        let kinds: Vec<_> = all.iter().map(ModelEffect::kind).collect();
        let [sinusoid, burst, rolloff, rounding, stale] = [
            sinusoid::KIND,
            burst::KIND,
            rolloff::KIND,
            rounding::KIND,
            stale::KIND,
        ];
        assert_eq!(kinds, [sinusoid, burst, rolloff, rounding, stale]);
    }

    #[test]
    fn rounding_behind_a_filter_is_in_the_model_once_whether_it_is_news_or_not() {
        let mut noise = Model::published(None).axes.remove(0);
        let known = ModelEffect::of(rounding::KIND, &[1e-3]).expect("a sound step");
        noise.effects.push(known);
        let found = Estimate::new(rounding::KIND, [Value::told(2e-3)]);
        for (findings, step) in [(vec![], 1e-3), (vec![Finding::new(&found, 0.0)], 2e-3)] {
            let all = all_effects(&findings, &noise);
            let steps: Vec<_> = all.iter().map(|one| (one.kind(), one.values())).collect();
            assert_eq!(steps, [(rounding::KIND, &[step][..])]);
        }
    }
}
