//! From a record in memory to what is wrong with its model and why.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::diagnosis::detect::common_mode::{self, Common};
use crate::diagnosis::record::samples::{Samples, Waiting};
use crate::diagnosis::record::spill::Aside;
use crate::diagnosis::result::finding::{AxisDiagnosis, Finding, Gain, Value};
use crate::diagnosis::rounds::Options;
use crate::diagnosis::{describe, explain};
use crate::model::PerCoefficient;
use crate::model::catalogue;

/// Samples below which no spectrum is worth the name.
pub const LEAST: usize = 1 << 13;

/// Samples of an axis above which the axes wait for one another, out of memory: each needs some forty
/// bytes a sample.
const LONG: usize = 1 << 22;

/// A record that cannot be diagnosed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// Too short.
    #[error(
        "axis {axis} has {samples} samples that count; a diagnosis needs {LEAST} or more; record longer"
    )]
    TooShort {
        /// Name of the axis.
        axis: String,
        /// Samples.
        samples: usize,
    },
    /// Nowhere enough samples in a row.
    #[error(
        "axis {axis}: no stretch without a missing sample is long enough for a spectrum; fill gaps of single samples, or choose a part of the record with --from and --to"
    )]
    Broken {
        /// Name of the axis.
        axis: String,
    },
    /// No model could be fitted.
    #[error(
        "axis {axis}: no mix of the five terms fits its spectrum; look at it with 'inm analyze', and choose a part of the record with --from and --to"
    )]
    Unfitted {
        /// Name of the axis.
        axis: String,
    },
    /// What waited out of memory is lost.
    #[error(
        "what waited in a file in {folder} cannot be read: {cause}; free space there, or set TMPDIR to another folder"
    )]
    Lost {
        /// Folder for temporary files.
        folder: String,
        /// Why.
        cause: String,
    },
    /// All the same, or nothing to fit.
    #[error("axis {axis}: all samples are the same, there is no noise to diagnose")]
    Constant {
        /// Name of the axis.
        axis: String,
    },
}

impl From<std::io::Error> for Refused {
    fn from(error: std::io::Error) -> Self {
        Self::Lost {
            folder: std::env::temp_dir().display().to_string(),
            cause: error.to_string(),
        }
    }
}

/// What has come of an axis meanwhile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// It is begun with.
    Begun,
    /// An effect was found in it, which may be given back later.
    Found(&'static str),
    /// It is done.
    Done,
}

/// Is told the name of an axis and what has come of it, by several threads.
pub type Progress<'a> = dyn Fn(&str, Step) + Sync + 'a;

/// Axes that are diagnosed.
#[derive(Debug, Clone)]
pub struct Diagnosed {
    /// In the order of the record.
    pub axes: Vec<AxisDiagnosis>,
    /// Correlation of their noise, where they share any.
    pub correlation: Option<Vec<Vec<f64>>>,
}

/// Diagnoses all axes, and what they have in common. What is needed no more is given up on
/// the way: a long record leaves no room for it.
///
/// # Errors
/// [`Refused`] where an axis holds too little.
pub fn diagnose(
    samples: Samples,
    options: &Options,
    progress: &Progress<'_>,
) -> Result<Diagnosed, Refused> {
    // All of it among the workers: a thread more would hold memory of its own.
    rayon::scope(|_| diagnose_axes(samples, options, progress))
}

fn diagnose_axes(
    samples: Samples,
    options: &Options,
    progress: &Progress<'_>,
) -> Result<Diagnosed, Refused> {
    let (mut axes, mut residuals) = (Vec::new(), Vec::new());
    let is_long = samples.len() > LONG;
    let at_once = if is_long {
        1
    } else {
        rayon::current_num_threads()
    };
    let signal = samples.signal;
    // The first axis does not wait.
    let wait = |(number, samples)| Waiting::new(samples, is_long && number > 0);
    let waiting: Vec<Waiting> = samples.axes.into_iter().enumerate().map(wait).collect();
    let mut waiting = signal.axes.iter().zip(waiting).peekable();
    while waiting.peek().is_some() {
        let some: Vec<_> = waiting.by_ref().take(at_once).collect();
        let done: Vec<_> = some
            .into_par_iter()
            .map(|(axis, record)| {
                progress(&axis.name, Step::Begun);
                let explained =
                    explain::explain(axis, record.back()?, signal.rate_hz, options, progress)?;
                let done = describe::describe(axis, explained, options);
                progress(&axis.name, Step::Done);
                Ok::<_, Refused>(done)
            })
            .collect();
        for one in done {
            let (axis, residual) = one?;
            axes.push(axis);
            residuals.push(Aside::new(residual, is_long));
        }
    }
    let residuals: Vec<Vec<f32>> = residuals
        .into_iter()
        .map(Aside::back)
        .collect::<Result<_, _>>()?;
    let shared = common_mode::shared(&residuals, signal.rate_hz, options.level());
    for common in &shared.axes {
        axes[common.axis].findings.push(common_finding(common));
    }
    Ok(Diagnosed {
        axes,
        correlation: shared.correlation,
    })
}

fn common_finding(common: &Common) -> Finding {
    let kind = catalogue::find("common_mode");
    let gain = common.gain.unwrap_or(f64::NAN);
    let mut parameters = BTreeMap::new();
    if let Some(gain) = common.gain {
        parameters.insert(
            "gain".to_owned(),
            Value::normal(gain, gain.abs() * common.gain_log_sd),
        );
    }
    Finding {
        effect: "common_mode".to_owned(),
        cause: kind.map_or_else(String::new, |kind| kind.meaning().to_owned()),
        check: kind.map_or_else(String::new, |kind| kind.check(&[gain])),
        parameters,
        p_value: common.p_value,
        rivals: Vec::new(),
        gain: Gain {
            heldout_nats: None,
            ..Gain::default()
        },
        without: PerCoefficient::default(),
    }
}
