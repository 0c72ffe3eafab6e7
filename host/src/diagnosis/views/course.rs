//! The record in time, in columns: extremes and mean of the samples, and of the model's
//! deterministic part, with the moments that findings are about.

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::finding::Finding;
use crate::diagnosis::result::views::{Column, Course, Extent, Mark};
use crate::model::marks;

/// Columns at most: about one a pixel of the picture.
const COLUMNS: usize = 1000;

/// Moments of one effect at most: a choice. More would hide the record.
const MOST_MARKS: usize = 200;

impl Extent {
    fn of(values: &[f64]) -> Self {
        let (mut lo, mut hi, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
        for &value in values.iter().filter(|value| value.is_finite()) {
            (lo, hi) = (lo.min(value), hi.max(value));
            sum += value;
            count += 1.0;
        }
        if count == 0.0 {
            (lo, hi) = (f64::NAN, f64::NAN);
        }
        Self {
            lo,
            mean: sum / count,
            hi,
        }
    }
}

impl Course {
    /// Of an axis with what was found in it; `mean` is that of the record.
    pub(crate) fn new(axis: &AxisState, findings: &[Finding], mean: f64) -> Self {
        let measured = axis.residual.measured();
        let modelled = modelled(axis);
        let column = measured.len().div_ceil(COLUMNS).max(1);
        let columns = measured.par_chunks(column).zip(modelled.par_chunks(column));
        Self {
            column_s: column as f64 / axis.rate_hz,
            columns: columns
                .map(|(measured, modelled)| Column {
                    measured: Extent::of(measured),
                    modelled: Extent::of(modelled),
                })
                .collect(),
            mean,
            marks: marks(axis, findings),
        }
    }

    /// Length of the course, seconds.
    pub fn duration_s(&self) -> f64 {
        self.column_s * self.columns.len() as f64
    }
}

/// The deterministic part of the model, about its mean as the record is about its own. Single
/// samples that do not belong are marked, not drawn.
fn modelled(axis: &AxisState) -> Vec<f64> {
    let mut values = vec![0.0; axis.residual.len()];
    for wave in axis.residual.waves() {
        if !matches!(wave, Wave::Outliers(_) | Wave::Replaced(_)) {
            wave.take_out(&mut values);
        }
    }
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter_mut().for_each(|value| *value = mean - *value);
    values
}

/// What findings say of moments and stretches: by their parameters, or, where these hold no moment, by what was
/// taken out of the record for them.
fn marks(axis: &AxisState, findings: &[Finding]) -> Vec<Mark> {
    let mut marks = Vec::new();
    for finding in findings {
        let effect = finding.effect;
        let spans = finding.marks().into_iter().filter_map(|mark| match mark {
            marks::Mark::Moment(at_s) => Some((at_s, at_s)),
            marks::Mark::Stretch(from_s, to_s) => Some((from_s, to_s)),
            _ => None,
        });
        let before = marks.len();
        marks.extend(spans.take(MOST_MARKS).map(|(from_s, to_s)| Mark {
            effect,
            from_s,
            to_s,
            is_sample: false,
        }));
        if marks.len() == before
            && let Some(explanation) = axis.explanation(effect)
        {
            let all = explanation.waves().iter().flat_map(events);
            marks.extend(all.take(MOST_MARKS).map(|(index, is_sample)| Mark {
                effect,
                from_s: index as f64 / axis.rate_hz,
                to_s: index as f64 / axis.rate_hz,
                is_sample,
            }));
        }
    }
    marks
}

/// Samples at which a waveform has events, and whether these are single samples.
fn events(wave: &Wave) -> Vec<(usize, bool)> {
    match wave {
        Wave::Outliers(all) => all.iter().map(|one| (one.index, true)).collect(),
        Wave::Steps(all) => all.iter().map(|one| (one.index, false)).collect(),
        _ => Vec::new(),
    }
}
