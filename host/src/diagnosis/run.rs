//! From a record in memory to what is wrong with its model and why.

use rayon::prelude::*;

use crate::diagnosis::detect::common_mode;
use crate::diagnosis::family::level_of_one_test;
use crate::diagnosis::options::Options;
pub use crate::diagnosis::progress::{Progress, Step};
use crate::diagnosis::record::samples::{Samples, Waiting};
use crate::diagnosis::record::spill::Spilled;
use crate::diagnosis::refused::Refused;
use crate::diagnosis::result::finding::AxisDiagnosis;
use crate::diagnosis::{describe, explain};

/// Samples of an axis above which the axes wait for one another, out of memory: each needs some forty
/// bytes a sample.
const LONG_RECORD: usize = 1 << 22;

/// What came of the axes of a record.
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
/// [`Refused`] where every axis holds too little; one that does among others is said to.
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
    let mut first_refused = None;
    let length = samples.len();
    let is_long = samples.len() > LONG_RECORD;
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
            let (axis, residual) = match one {
                Err(Refused::Lost { .. }) => one?,
                Err(refused) => {
                    let done = describe::undiagnosed(&signal.axes[axes.len()], &refused);
                    first_refused.get_or_insert(refused);
                    (done, vec![f32::NAN; length])
                }
                Ok(done) => done,
            };
            axes.push(axis);
            residuals.push(Spilled::new(residual, is_long));
        }
    }
    if let Some(refused) = first_refused
        && axes.iter().all(|one: &AxisDiagnosis| one.refused.is_some())
    {
        return Err(refused);
    }
    let residuals: Result<Vec<_>, _> = residuals.into_iter().map(Spilled::back).collect();
    Ok(together(axes, &residuals?, signal.rate_hz, options))
}

/// The axes with what their `residuals` share.
fn together(
    mut axes: Vec<AxisDiagnosis>,
    residuals: &[Vec<f32>],
    rate_hz: f64,
    options: &Options,
) -> Diagnosed {
    let shared = common_mode::shared(residuals, rate_hz, level_of_one_test(options));
    for common in &shared.axes {
        axes[common.axis]
            .findings
            .push(common_mode::finding(common));
    }
    Diagnosed {
        axes,
        correlation: shared.correlation,
    }
}
