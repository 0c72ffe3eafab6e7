//! Clipping: samples pile up at an extreme value.

use std::sync::Arc;

use super::Detector;
use super::outliers::filter;
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::clipping::KIND;

/// Looks for pile-ups at both extremes.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let values = look.context.values;
    let known = look.axis.explanations().iter();
    // One side after the other, the second in the noise that is left without the first.
    let known = known.filter(|one| one.kind() == KIND).count();
    let Some((clipping, places)) = values.clipping.get(known) else {
        return Ok(Vec::new());
    };
    let seen = look.axis.whitened();
    // Known to the rounding of the mean that was taken out and put back.
    let slack = 4.0 * f64::EPSILON * values.largest;
    let level = Value::normal(clipping.level, slack);
    let replaced = filter::sizes_at(&seen.transform, &seen.density, places);
    let candidate = Candidate::new(
        Estimate::new(KIND, [level, Value::exact(clipping.side)]),
        clipping.p_value,
        1.0,
        Change::Waves(vec![Wave::Replaced(Arc::new(replaced))]),
    );
    Ok(vec![Proposal::Explain(Box::new(candidate))])
}
