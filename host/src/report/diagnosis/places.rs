//! Where findings show: in frequency, in averaging time.

use crate::diagnosis::result::finding::{AxisDiagnosis, Finding};
use crate::model::marks::Mark;
use crate::numeric::written::plain;

/// A name at a frequency or an averaging time.
pub type Label = (f64, String);

/// A band between two frequencies, hertz.
pub type Band = (f64, f64);

/// A frequency for a label: five digits, no superfluous zeros.
fn hertz(f_hz: f64) -> String {
    let rounded: f64 = format!("{f_hz:.4e}").parse().unwrap_or(f_hz);
    format!("{} Hz", plain(rounded))
}

/// All places at which the findings of an axis show.
fn marks(axis: &AxisDiagnosis) -> impl Iterator<Item = (&Finding, Mark)> {
    let findings = axis.findings.iter();
    findings.flat_map(|one| one.marks().into_iter().map(move |mark| (one, mark)))
}

/// Frequencies at which findings show as lines, peaks and corners.
pub fn frequencies(axis: &AxisDiagnosis) -> Vec<Label> {
    let label = |(finding, mark): (&Finding, Mark)| match mark {
        Mark::Line { f_hz, multiple: 1 } => {
            Some((f_hz, format!("{} {}", finding.effect, hertz(f_hz))))
        }
        Mark::Line { f_hz, multiple } => Some((f_hz, format!("{multiple}\u{d7}"))),
        Mark::Corner(f_hz) => Some((f_hz, format!("{}, corner {}", finding.effect, hertz(f_hz)))),
        _ => None,
    };
    marks(axis).filter_map(label).collect()
}

/// Averaging times at which findings add most to the Allan variance.
pub fn averaging_times(axis: &AxisDiagnosis) -> Vec<Label> {
    let label = |(finding, mark): (&Finding, Mark)| match mark {
        Mark::AveragingTime(tau_s) => Some((tau_s, finding.effect.to_string())),
        _ => None,
    };
    marks(axis).filter_map(label).collect()
}

/// Bands that findings fill, and those that are left unexplained.
pub fn bands(axis: &AxisDiagnosis) -> (Vec<Band>, Vec<Band>) {
    let found = marks(axis).filter_map(|(_, mark)| match mark {
        Mark::Band(from_hz, to_hz) => Some((from_hz, to_hz)),
        _ => None,
    });
    let unexplained = axis.unexplained.iter();
    let unexplained = unexplained.filter_map(|remark| remark.place.band_hz());
    (
        found.collect(),
        unexplained
            .map(|[from_hz, to_hz]| (from_hz, to_hz))
            .collect(),
    )
}
