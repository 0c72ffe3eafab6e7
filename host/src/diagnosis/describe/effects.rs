//! Effects as findings, and as a model file has them.

use std::collections::BTreeMap;

use crate::diagnosis::laws;
use crate::diagnosis::record::bins::Frame;
use crate::diagnosis::result::coefficients::coefficients_of;
use crate::diagnosis::result::finding::{Finding, Gain};
use crate::diagnosis::rounds::{self, Accepted, Snapshot};
use crate::fit::likelihood::Fit;
use crate::model::PerCoefficient;
use crate::model::axis::ModelEffect;
use crate::model::catalogue;
use crate::model::effect::Effect;

/// Findings as a model file has them, where the catalogue can make them.
pub(crate) fn named_effects(findings: &[Finding]) -> Vec<ModelEffect> {
    findings
        .iter()
        .filter_map(|finding| {
            let mut parameters: BTreeMap<String, f64> = finding
                .parameters
                .iter()
                .map(|(name, value)| (name.clone(), value.value))
                .collect();
            if finding.effect == "hum" {
                fill_harmonics(&mut parameters);
            }
            ModelEffect::new(&finding.effect, &parameters).ok()
        })
        .collect()
}

/// A model file numbers harmonics without holes: those that were not found are zero.
fn fill_harmonics(parameters: &mut BTreeMap<String, f64>) {
    let number = |name: &String| name.strip_prefix("amplitude_")?.parse().ok();
    let last: u32 = parameters.keys().filter_map(number).max().unwrap_or(0);
    for number in 1..=last {
        parameters
            .entry(format!("amplitude_{number}"))
            .or_insert(0.0);
    }
}

/// The laws of a snapshot with the sizes of a fit that has them.
pub(crate) fn law_effects(frame: &Frame, snapshot: &Snapshot, fit: &Fit) -> Vec<ModelEffect> {
    let laws = rounds::laws_of(snapshot);
    (0..laws.len())
        .filter_map(|which| {
            let law = &laws[which];
            let values = laws::sized(frame, &laws, which, fit);
            let parameters = law
                .effect
                .parameters(&values)
                .iter()
                .zip(&values)
                .map(|(parameter, value)| (parameter.name.to_string(), *value))
                .collect();
            ModelEffect::new(law.effect.name(), &parameters).ok()
        })
        .collect()
}

/// An effect with its gains, as it is told.
pub(crate) fn finding(one: &Accepted, gain: Gain) -> Finding {
    let kind: Option<&'static dyn Effect> = catalogue::find(one.effect);
    let values: Vec<f64> = kind.map_or_else(Vec::new, |kind| {
        let count = vec![0.0; one.parameters.len()];
        kind.parameters(&count)
            .iter()
            .map(|parameter| {
                one.parameters
                    .get(parameter.name.as_ref())
                    .map_or(0.0, |value| value.value)
            })
            .collect()
    });
    Finding {
        effect: one.effect.to_owned(),
        cause: kind.map_or_else(String::new, |kind| kind.meaning().to_owned()),
        check: kind.map_or_else(String::new, |kind| kind.check(&values)),
        parameters: one.parameters.clone(),
        p_value: one.p_value,
        rivals: one.rivals.clone(),
        gain,
        without: PerCoefficient::from_fn(|letter| coefficients_of(&one.before).get(letter).value),
    }
}
