//! Lines that do not keep their size and phase: no fit looks at what is about them.

use super::{Group, Measured, lines, measure, resonances_hz, wandering, wanders};
use crate::diagnosis::axis::{Excluded, NoFit};
use crate::diagnosis::detect::Detector;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::numeric::written::significant;

/// Excludes the lines that wander, once no resonance can be what makes them. Their tests are those of
/// [`DETECTOR`](super::DETECTOR).
pub static WANDERING: Detector = Detector {
    tests: 0,
    look: look_for_wandering,
};

fn look_for_wandering(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let mut known = look.axis.excluded_hz();
    known.extend(resonances_hz(look.axis));
    let mut proposals = Vec::new();
    for group in lines(look.axis, look.level()) {
        let Group::Single(one) = group else { continue };
        let f_hz = one.line.frequency_hz;
        let is_known = known.iter().any(|band| band.contains(&f_hz));
        if wanders(look, &one) && !is_known && !measure::is_left_of_known(look.axis, &one.line) {
            let excluded = excluded(look, &one);
            known.push(excluded.band_hz.clone());
            proposals.push(Proposal::ExcludeLine(excluded));
        }
    }
    Ok(proposals)
}

fn excluded(look: &Look<'_>, one: &Measured) -> Excluded {
    /// Width of what is excluded, 1/T on either side: a choice.
    const WANDER_REACH: f64 = 40.0;
    let f_hz = one.line.frequency_hz;
    let width_hz = WANDER_REACH * look.axis.rate_hz / look.axis.filled.len() as f64;
    Excluded {
        band_hz: f_hz - width_hz..f_hz + width_hz,
        remark: Remark {
            test: "lines".into(),
            place: Place::Line(f_hz),
            p_value: one.line.false_alarm,
            description: format!(
                "a line of amplitude {} that does not keep its size and phase: {}",
                significant(one.line.amplitude, 4),
                wandering(f_hz)
            ),
        },
    }
}
