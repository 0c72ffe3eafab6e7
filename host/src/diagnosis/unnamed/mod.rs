//! What has no name is in the model all the same.
//!
//! Once every detector and every doubt is heard, the spectrum of what is left is compared with the model once
//! more, excluded bands included. Where it departs, bands of noise without a name are added until nothing
//! significant is left, and the sizes of everything are fitted anew together with them: a name explains a part of a
//! model that is right already, and what a name does not explain is not missing from the model.

mod bands;
mod dictionary;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws::departure::departure;
use crate::fit::likelihood::Data;
use crate::model::effect::Part;
use crate::numeric::mixture::add_mixture;

/// Factor on the power of a tone beside all else from which its law is not that of what is there: 3 dB are a choice. Tones
/// that were named right come to 0.9 to 1.15 in measured records.
const ANOTHER: f64 = 2.0;

/// What became of a model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Completed {
    /// Probability of what was missing, in data of the model without it; `None` where nothing was.
    pub p_value: Option<f64>,
    /// Numbers of the explanations that were taken back, one after the other.
    pub withdrawn: Vec<usize>,
}

/// Adds to an axis's model what none of its explanations speaks for, where anything is missing at a `level`. A tone whose
/// law does not hold beside that is taken back, and left to the noise without a name.
pub fn complete(axis: &mut AxisState, level: f64) -> Completed {
    let mut withdrawn = Vec::new();
    loop {
        let data = Data {
            dof: axis.bins.dof().to_vec(),
            ..axis.data.clone()
        };
        let tones = tones(axis);
        let Some((p_value, completed)) = lacking(axis, &data, &tones, level) else {
            let p_value = None;
            return Completed { p_value, withdrawn };
        };
        if let Some(number) = another(&completed.tones) {
            withdrawn.extend(axis.withdraw_tone(number));
            if axis.refresh().is_ok() {
                continue;
            }
            // What is left cannot be fitted: the model stays as it was.
            let p_value = None;
            return Completed { p_value, withdrawn };
        }
        axis.resize_tones(&completed.tones);
        // The fit is that of the noise: where tones are, it says nothing by itself.
        let data = Data {
            dof: axis.bins.dof_beside(&axis.tones_hz()),
            ..data
        };
        axis.complete(completed.laws, completed.fit, data);
        let p_value = Some(p_value);
        return Completed { p_value, withdrawn };
    }
}

/// What a model lacks, and the probability of as much by chance; `None` where that is not below `level`.
fn lacking(
    axis: &AxisState,
    data: &Data,
    tones: &[Vec<f64>],
    level: f64,
) -> Option<(f64, bands::Completed)> {
    let mut expected = axis.fit.expected.clone();
    add_mixture(&mut expected, tones, &vec![1.0; tones.len()]);
    let p_value = departure(data, &expected)?.p_value;
    let completed = (p_value < level).then(|| bands::fitted(axis, data, tones));
    Some((p_value, completed??))
}

/// The tone that has to change most, if that is by as much as makes it another.
fn another(powers: &[f64]) -> Option<usize> {
    let changes = powers.iter().map(|power| power.max(power.recip()));
    let most = changes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (most.1 > ANOTHER).then_some(most.0)
}

/// What the bins are expected to be of each tone that has a name and is no part of any fit.
fn tones(axis: &AxisState) -> Vec<Vec<f64>> {
    let named = axis.explanations().iter();
    let own = named.filter(|one| one.is_tone()).map(|one| {
        let Part::Term(term) = one.kind().part(&one.effect.plain()) else {
            return vec![0.0; axis.data.len()];
        };
        let bins = &axis.bins;
        bins.expect(|f_hz| bins.term_density(&*term, f_hz) * axis.filters(f_hz))
    });
    own.collect()
}
