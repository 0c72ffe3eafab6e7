//! Where findings show: in frequency, in averaging time.

use std::f64::consts::PI;

use crate::diagnosis::result::finding::{AxisDiagnosis, Finding};
use crate::report::number::plain;

/// A name at a frequency or an averaging time.
pub type Place = (f64, String);

/// A band between two frequencies, hertz.
pub type Band = (f64, f64);

fn value(finding: &Finding, name: &str) -> Option<f64> {
    finding.parameters.get(name).map(|one| one.value)
}

/// A frequency for a label: five digits, no superfluous zeros.
fn hertz(f_hz: f64) -> String {
    let rounded: f64 = format!("{f_hz:.4e}").parse().unwrap_or(f_hz);
    format!("{} Hz", plain(rounded))
}

/// Harmonics of a hum, by their number.
fn harmonics(finding: &Finding) -> impl Iterator<Item = u32> + '_ {
    finding
        .parameters
        .iter()
        .filter(|(_, value)| value.value != 0.0)
        .filter_map(|(name, _)| name.strip_prefix("amplitude_")?.parse().ok())
}

/// Frequencies at which findings show as lines, peaks and corners.
pub fn frequencies(axis: &AxisDiagnosis) -> Vec<Place> {
    let mut places = Vec::new();
    for finding in &axis.findings {
        let name = finding.effect.as_str();
        let value = |name| value(finding, name);
        match (name, value("f_hz")) {
            ("hum", Some(f_hz)) => {
                let mut numbers: Vec<u32> = harmonics(finding).collect();
                numbers.sort_unstable();
                for number in numbers {
                    let at = f_hz * f64::from(number);
                    let text = match number {
                        1 => format!("hum {}", hertz(at)),
                        _ => format!("{number}\u{d7}"),
                    };
                    places.push((at, text));
                }
            }
            (_, Some(f_hz)) => places.push((f_hz, format!("{name} {}", hertz(f_hz)))),
            _ => {}
        }
        let corner = value("corner_hz")
            .or_else(|| value("time_s").map(|time_s| 1.0 / (2.0 * PI * time_s)))
            .or_else(|| value("dwell_s").map(|dwell_s| 1.0 / (PI * dwell_s)));
        if let Some(corner_hz) = corner.filter(|_| name != "warmup") {
            places.push((corner_hz, format!("{name}, corner {}", hertz(corner_hz))));
        }
    }
    places
}

/// Averaging times at which findings add most to the Allan variance (docs/effects.md).
pub fn averaging_times(axis: &AxisDiagnosis) -> Vec<Place> {
    let place = |finding: &Finding| {
        let value = |name| value(finding, name);
        let tau_s = match finding.effect.as_str() {
            "sinusoid" | "hum" => 0.37 / value("f_hz")?,
            "markov" => 1.89 * value("time_s")?,
            "telegraph" => 0.945 * value("dwell_s")?,
            _ => return None,
        };
        Some((tau_s, finding.effect.clone()))
    };
    axis.findings.iter().filter_map(place).collect()
}

/// Bands of resonances, and those that are left unexplained.
pub fn bands(axis: &AxisDiagnosis) -> (Vec<Band>, Vec<Band>) {
    let resonance = |finding: &Finding| {
        let (f_hz, width_hz) = (value(finding, "f_hz")?, value(finding, "width_hz")?);
        Some((
            (f_hz - 0.5 * width_hz).max(0.5 * f_hz),
            f_hz + 0.5 * width_hz,
        ))
    };
    (
        axis.findings.iter().filter_map(resonance).collect(),
        axis.unexplained
            .iter()
            .filter_map(|remark| remark.place.band_hz())
            .map(|[from_hz, to_hz]| (from_hz, to_hz))
            .collect(),
    )
}
