//! What is significant still when nothing in the catalogue explains more.

use super::Doubt;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::lines::{self, Group};
use crate::diagnosis::laws::departure::{self, Departure};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::steady::strength::{self, Wander};
use crate::model::rounding;

/// What is left of the spectrum, of lines and of the strength over time. One test; those of lines and of the
/// strength are counted with their detectors.
pub static DOUBT: Doubt = Doubt {
    tests: 1,
    hear: |hearing| {
        let mut remarks = left_over(hearing.axis, hearing.level);
        remarks.append(&mut hearing.remarks);
        hearing.remarks = remarks;
        Ok::<(), NoFit>(())
    },
};

/// Where the spectrum of an axis departs from its model, if it does at a `level`.
pub fn of_spectrum(axis: &AxisState, level: f64) -> Option<Departure> {
    let departure = departure::departure(&axis.data, &axis.fit.expected);
    departure.filter(|one| one.p_value < level)
}

/// What there is to say of a departure of the spectrum.
pub fn spectrum_remark(departure: &Departure) -> Remark {
    Remark {
        test: "spectrum".into(),
        place: (departure.from_hz..departure.to_hz).into(),
        p_value: departure.p_value,
        description: format!(
            "{:.3} times the power that the model expects there",
            departure.ratio
        ),
    }
}

fn left_over(axis: &AxisState, level: f64) -> Vec<Remark> {
    let departure = of_spectrum(axis, level);
    let spectrum = departure.as_ref().map(spectrum_remark);
    let mut remarks: Vec<Remark> = spectrum.into_iter().collect();
    remarks.extend(of_lines(axis, level));
    remarks.extend(of_strength(axis, level));
    remarks
}

/// Lines too close to one another to be separate.
fn of_lines(axis: &AxisState, level: f64) -> impl Iterator<Item = Remark> {
    let mut known = lines::resonances_hz(axis);
    known.extend(axis.excluded_hz());
    let groups = lines::lines(axis, level).into_iter();
    groups.filter_map(move |group| match group {
        Group::Cluster {
            f_hz,
            width_hz,
            lines,
        } if !known.iter().any(|band| band.contains(&f_hz)) => {
            let p_values = lines.iter().map(|line| line.false_alarm);
            Some(Remark {
                test: "lines".into(),
                place: (f_hz - 0.5 * width_hz..f_hz + 0.5 * width_hz).into(),
                p_value: p_values.fold(1.0, f64::min),
                description: format!(
                    "power in {} narrow lines that stand too close to be separate: {}",
                    lines.len(),
                    lines::wandering(f_hz)
                ),
            })
        }
        _ => None,
    })
}

/// A remark on noise whose strength moves, where it does.
fn of_strength(axis: &AxisState, level: f64) -> Option<Remark> {
    if axis.has(rounding::KIND) {
        return None;
    }
    let Wander { cyclic, slow } = strength::wander(&axis.powers())?;
    let movements = [
        (
            cyclic,
            Place::Period as fn(f64) -> Place,
            "rises and falls in a cycle",
        ),
        (slow, Place::Slower, "changes in time"),
    ];
    // One movement shows in both: a cycle is the plainer of the two.
    let mut seen = movements.iter();
    let (movement, place, how) = seen.find(|(one, ..)| one.p_value < level)?;
    Some(Remark {
        test: "variance".into(),
        place: place(movement.period / axis.rate_hz),
        p_value: movement.p_value,
        description: format!("the strength of the noise {how}"),
    })
}
