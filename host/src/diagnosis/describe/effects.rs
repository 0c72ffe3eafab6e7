//! Effects as findings, and as a model file has them.

use crate::diagnosis::describe::coefficients::coefficients_of;
use crate::diagnosis::explanation::{Explanation, Snapshot};
use crate::diagnosis::laws;
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::{Finding, Gain};
use crate::fit::likelihood::Fit;
use crate::model::axis::{ModelAxis, ModelEffect};
use crate::model::{PerCoefficient, unnamed};

/// Findings as a model file has them, where data can be made of them, and what of the `noise` has no name; a harmonic
/// that was not found is zero there.
pub fn all_effects(findings: &[Finding], noise: &ModelAxis) -> Vec<ModelEffect> {
    let effect =
        |finding: &Finding| ModelEffect::of(finding.effect, &finding.estimate.plain()).ok();
    let unnamed = noise.effects.iter();
    let unnamed = unnamed.filter(|one| one.kind() == unnamed::KIND).cloned();
    findings.iter().filter_map(effect).chain(unnamed).collect()
}

/// The laws of a snapshot with the sizes of a fit that has them, and its tones as they were measured.
pub fn law_effects(bins: &SpectralBins, snapshot: &Snapshot, fit: &Fit) -> Vec<ModelEffect> {
    let sized = |which: usize| {
        let values = laws::sized(bins, &snapshot.laws, which, fit);
        ModelEffect::of(snapshot.laws[which].effect, &values).ok()
    };
    let measured = |one: &Estimate| ModelEffect::of(one.kind, &one.plain()).ok();
    let laws = (0..snapshot.laws.len()).filter_map(sized);
    laws.chain(snapshot.tones.iter().filter_map(measured))
        .collect()
}

/// An explanation with its gains, as it is reported.
pub fn finding(one: &Explanation, gain: Gain) -> Finding {
    Finding {
        rivals: one.rivals.clone(),
        gain,
        without: PerCoefficient::from_fn(|letter| coefficients_of(&one.before).get(letter).value),
        ..Finding::new(&one.effect, one.p_value)
    }
}
