//! What has no name is in the model all the same.
//!
//! Once every detector and every doubt is heard, the spectrum of what is left is compared with the model once
//! more, excluded bands included. Where it departs, bands of noise without a name are added until nothing
//! significant is left, and the sizes of everything are fitted anew together with them: a name explains a part of a
//! model that is right already, and what a name does not explain is not missing from the model.

mod bands;
mod gain;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws::departure::departure;
use crate::fit::likelihood::Data;
use crate::model::effect::Part;

/// Adds to an axis's model what none of its explanations speaks for; its probability in data of the model, `None`
/// where nothing is missing at a `level`.
pub fn complete(axis: &mut AxisState, level: f64) -> Option<f64> {
    let data = Data {
        dof: axis.bins.dof().to_vec(),
        ..axis.data.clone()
    };
    let tones = tones(axis);
    let pairs = axis.fit.expected.iter().zip(&tones);
    let expected: Vec<f64> = pairs.map(|(noise, tones)| noise + tones).collect();
    let p_value = departure(&data, &expected)?.p_value;
    if p_value >= level {
        return None;
    }
    let (laws, fit) = bands::fitted(axis, &data, &tones)?;
    // The fit is that of the noise: where tones are, it says nothing by itself.
    let data = Data {
        dof: axis.bins.dof_beside(&axis.tones_hz()),
        ..data
    };
    axis.complete(laws, fit, data);
    Some(p_value)
}

/// What the bins are expected to be of tones that have a name and are no part of any fit.
fn tones(axis: &AxisState) -> Vec<f64> {
    let mut all = vec![0.0; axis.data.len()];
    let named = axis.explanations().iter();
    for one in named.filter(|one| !one.bands_hz().is_empty()) {
        if let Part::Term(term) = one.kind().part(&one.effect.plain()) {
            let bins = &axis.bins;
            let own = bins.expect(|f_hz| bins.term_density(&*term, f_hz) * axis.filters(f_hz));
            all.iter_mut().zip(own).for_each(|(all, own)| *all += own);
        }
    }
    all
}
