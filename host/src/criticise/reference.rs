//! A record beside another of the same sensor: is its clock right?

use super::axis::AxisState;
use super::finding::{Finding, Gain, Value};
use super::lines::{self, Group};
use super::samples::Samples;
use super::timebase;
use crate::model::PerCoefficient;
use crate::model::catalogue;

/// The finding that an axis of `samples` was taken at another rate than it says, beside the same
/// axis of `reference`, at a family-wise `level`.
pub fn clock(samples: &Samples, reference: &Samples, number: usize, level: f64) -> Option<Finding> {
    let record = lines_of(samples, number, level)?;
    let other = lines_of(reference, number, level)?;
    let rate = timebase::ratio(&record, &other, level)?;
    let kind = catalogue::find("timebase")?;
    Some(Finding {
        effect: kind.name().to_owned(),
        cause: kind.meaning().to_owned(),
        check: kind.check(&[rate.ratio]),
        parameters: [("ratio".to_owned(), Value::normal(rate.ratio, rate.ratio_sd))].into(),
        p_value: rate.p_value,
        rivals: Vec::new(),
        gain: Gain::default(),
        without: PerCoefficient::default(),
    })
}

/// Frequency and standard deviation of every line of an axis, hertz.
fn lines_of(samples: &Samples, number: usize, level: f64) -> Option<Vec<(f64, f64)>> {
    let signal = samples.signal.axes.get(number)?;
    let (measured, _) = samples.axes.get(number)?.centred(signal.scale);
    let axis = AxisState::new(measured, samples.signal.rate_hz, signal.chain.as_ref())?;
    let mut found: Vec<(f64, f64)> = lines::lines(&axis, level)
        .into_iter()
        .flat_map(|group| match group {
            Group::Single(one) => vec![one.line],
            Group::Hum { lines, .. } => lines.into_iter().map(|(_, one)| one.line).collect(),
            Group::Cluster { lines, .. } => lines,
        })
        .map(|line| (line.frequency_hz, line.frequency_sd_hz))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some(found)
}
