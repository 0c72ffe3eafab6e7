//! The record in time, in columns: extremes and mean of the samples, and of the model's
//! deterministic part, with the moments that findings are about.

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::residual::Wave;
use crate::diagnosis::result::finding::Finding;

/// Columns at most.
const COLUMNS: usize = 1000;

/// Moments of one effect at most.
const MOST: usize = 200;

/// Time constants after which a settling is over for the eye.
const SETTLED: f64 = 5.0;

/// The record in time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Course {
    /// Length of a column, seconds.
    pub column_s: f64,
    /// The columns; values are about [`Course::mean`].
    pub columns: Vec<Column>,
    /// Mean of the record.
    pub mean: f64,
    /// What happened.
    pub marks: Vec<Mark>,
}

/// Some neighbouring samples; all NaN where all are missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// The record.
    pub measured: Extent,
    /// The deterministic part of the model.
    pub modelled: Extent,
}

/// Extremes and mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Lowest.
    pub lo: f64,
    /// Mean.
    pub mean: f64,
    /// Highest.
    pub hi: f64,
}

/// A moment or a stretch of time that a finding is about.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Effect.
    pub effect: String,
    /// Begin, seconds.
    pub from_s: f64,
    /// End, seconds; the same as the begin for a moment.
    pub to_s: f64,
}

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
        let measured = axis.mended.measured();
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

    /// Length, seconds.
    pub fn duration_s(&self) -> f64 {
        self.column_s * self.columns.len() as f64
    }
}

/// The deterministic part of the model, about its mean as the record is about its own. Single
/// samples that do not belong are marked, not drawn.
fn modelled(axis: &AxisState) -> Vec<f64> {
    let mut values = vec![0.0; axis.mended.len()];
    for wave in &axis.mended.waves {
        if !matches!(wave, Wave::Outliers(_) | Wave::Replaced(_)) {
            wave.take_out(&mut values);
        }
    }
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter_mut().for_each(|value| *value = mean - *value);
    values
}

fn marks(axis: &AxisState, findings: &[Finding]) -> Vec<Mark> {
    let mut marks = Vec::new();
    for finding in findings {
        let value = |name: &str| finding.parameters.get(name).map(|one| one.value);
        let mut add = |from_s: f64, to_s: f64| {
            marks.push(Mark {
                effect: finding.effect.clone(),
                from_s,
                to_s,
            });
        };
        if let (Some(from_s), Some(to_s)) = (value("from_s"), value("to_s")) {
            add(from_s, to_s);
        }
        if let ("warmup", Some(time_s)) = (finding.effect.as_str(), value("time_s")) {
            add(0.0, SETTLED * time_s);
        }
        let numbered = (1..=MOST).map_while(|number| value(&format!("time_s_{number}")));
        numbered.for_each(|time_s| add(time_s, time_s));
    }
    let moment = |effect: &str, index: usize| Mark {
        effect: effect.to_owned(),
        from_s: index as f64 / axis.rate_hz,
        to_s: index as f64 / axis.rate_hz,
    };
    let switches = findings.iter().any(|one| one.effect == "telegraph");
    for wave in &axis.mended.waves {
        match wave {
            Wave::Outliers(all) => {
                let all = all.iter().take(MOST);
                marks.extend(all.map(|one| moment("outliers", one.index)));
            }
            Wave::Steps(jumps) if switches => {
                let jumps = jumps.iter().take(MOST);
                marks.extend(jumps.map(|one| moment("telegraph", one.index)));
            }
            _ => {}
        }
    }
    marks
}
