//! Lines in the place of resonances that the record cannot resolve.

use super::measure::measure_near;
use super::{single, slow, taken_out_hz, wanders};
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::spectrum::record_lines::LEAST_CYCLES;

/// Numbers of a line, a nat each: frequency, amplitude and phase.
const NUMBERS: f64 = 3.0;

/// A resonance too narrow for the record to resolve: a line, if the record has cycles enough for one; a few of them are
/// a course of the level like any other.
pub fn unresolved(look: &Look<'_>, f_hz: f64, p_value: f64) -> Option<Proposal> {
    if f_hz * look.duration_s() < LEAST_CYCLES {
        return None;
    }
    let one = measure_near(look.axis, f_hz, p_value);
    if wanders(look, &one) {
        return None;
    }
    single(look, &mut taken_out_hz(look.axis), one)
}

/// The line in the place of a resonance of a few cycles in the record, found with the probability `p_value` by chance and `worth` so many
/// nats: where all that it is stands in a few ordinates, one of them may be a line's. It is one if, taken out, it is worth more.
///
/// # Errors
/// [`NoFit`] where what is left cannot be fitted.
pub fn in_place_of(
    look: &Look<'_>,
    f_hz: f64,
    p_value: f64,
    worth: f64,
) -> Result<Option<Proposal>, NoFit> {
    let cycles = f_hz * look.duration_s();
    if !(slow::FEWEST as f64..LEAST_CYCLES).contains(&cycles) {
        return Ok(None);
    }
    let one = measure_near(look.axis, f_hz, p_value);
    let line = (!wanders(look, &one)).then(|| single(look, &mut taken_out_hz(look.axis), one));
    let Some(Proposal::Explain(candidate)) = line.flatten() else {
        return Ok(None);
    };
    let mut with = look.axis.clone();
    with.accept((*candidate).clone())?;
    let gain = with.fit.log_likelihood - look.axis.fit.log_likelihood;
    Ok((gain - NUMBERS > worth).then_some(Proposal::Explain(candidate)))
}
