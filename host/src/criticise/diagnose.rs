//! From a record in memory to what is wrong with its model and why.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::aside::Aside;
use super::axis::AxisState;
use super::codes::CodeFindings;
use super::coefficients::{coefficients, coefficients_of, even_density, of_ramp};
use super::coherence::{self, Common};
use super::finding::{AxisDiagnosis, Base, Final, Finding, Gain, Value};
use super::frame::Frame;
use super::gain::allan::HeldCurve;
use super::gain::laws::Ordinates;
use super::gain::size::Sizes;
use super::gain::{self, Halves};
use super::laws;
use super::mend::Mended;
use super::ramp;
use super::rounds::{self, Accepted, Options, Snapshot};
use super::samples::{AxisSamples, Samples, Waiting};
use super::views::{Before, Models, Views};
use crate::fft::ring::Series;
use crate::fit::likelihood::Fit;
use crate::fit::likelihood::components::SEEN;
use crate::fit::likelihood::ramp::Ramp;
use crate::model::catalogue;
use crate::model::effect::Effect;
use crate::model::whole::{ModelAxis, ModelEffect};
use crate::model::{Coefficient as Letter, PerCoefficient};
use crate::signal::Axis;
use crate::source::Values;

/// Samples below which no spectrum is worth the name.
const LEAST: usize = 1 << 13;

/// Samples of an axis above which the axes wait for one another, out of memory: each needs some forty
/// bytes a sample.
const LONG: usize = 1 << 22;

/// Effects that may be refused before the rest is taken as it is.
const MOST_REFUSED: usize = 4;

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

/// Diagnoses all axes, and what they have in common. `progress` is told each axis that is done. What
/// is needed no more is given up on the way: a long record leaves no room for it.
///
/// # Errors
/// [`Refused`] where an axis holds too little.
pub fn diagnose(
    samples: Samples,
    options: &Options,
    progress: impl FnMut(usize) + Send,
) -> Result<Vec<AxisDiagnosis>, Refused> {
    // All of it among the workers: a thread more would hold memory of its own.
    rayon::scope(|_| diagnose_axes(samples, options, progress))
}

fn diagnose_axes(
    samples: Samples,
    options: &Options,
    mut progress: impl FnMut(usize),
) -> Result<Vec<AxisDiagnosis>, Refused> {
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
            .map(|(axis, record)| diagnose_axis(axis, record.back()?, signal.rate_hz, options))
            .collect();
        for one in done {
            let (axis, residual) = one?;
            progress(axes.len());
            axes.push(axis);
            residuals.push(Aside::new(residual, is_long));
        }
    }
    let residuals: Vec<Vec<f32>> = residuals
        .into_iter()
        .map(Aside::back)
        .collect::<Result<_, _>>()?;
    for common in coherence::common(&residuals, signal.rate_hz, options.level()) {
        axes[common.axis].findings.push(common_finding(&common));
    }
    Ok(axes)
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

/// Diagnoses one axis; also hands over what is left of it.
///
/// # Errors
/// [`Refused`] where the record holds too little.
fn diagnose_axis(
    signal: &Axis,
    record: AxisSamples,
    rate_hz: f64,
    options: &Options,
) -> Result<(AxisDiagnosis, Vec<f32>), Refused> {
    let declared = matches!(record.raw(), Values::Codes(_)).then_some(signal.scale);
    let (measured, mean) = record.centred(signal.scale);
    let good = measured.iter().filter(|value| value.is_finite()).count();
    if good < LEAST {
        return Err(Refused::TooShort {
            axis: signal.name.clone(),
            samples: good,
        });
    }
    let mean = mean - signal.zero * signal.scale;
    let measured = Arc::new(measured);
    let refusal = || {
        let axis = signal.name.clone();
        let mut there = measured.iter().filter(|value| value.is_finite());
        let first = there.next();
        if there.all(|value| Some(value) == first) {
            Refused::Constant { axis }
        } else {
            Refused::Broken { axis }
        }
    };
    let values = CodeFindings::new(declared, options.level(), &measured, mean);
    let mut refused: Vec<&'static str> = Vec::new();
    let mut begun: Option<(Before, f64)> = None;
    let (axis, base_fit, outcome, nats) = loop {
        let mut axis = AxisState::new(Arc::clone(&measured), rate_hz, signal.chain.as_ref())
            .ok_or_else(refusal)?;
        let base_fit = axis.fit.clone();
        let begin = || {
            begun.get_or_insert_with(|| (Before::new(&axis), slope(ramp::ramp(&axis))));
            axis.powers();
        };
        rayon::join(|| axis.lines(options.level()), begin);
        let outcome = rounds::run(&mut axis, options, &values, &refused).ok_or_else(refusal)?;
        let nats = held_out(&axis, &outcome.accepted);
        // What gains nothing on data that it was not fitted to is no effect.
        let losers = outcome.accepted.iter().zip(&nats);
        let losers: Vec<&'static str> = losers
            .filter(|(_, nats)| nats.is_some_and(|nats| nats <= 0.0))
            .map(|(one, _)| one.effect)
            .collect();
        if losers.is_empty() || refused.len() > MOST_REFUSED {
            break (axis, base_fit, outcome, nats);
        }
        refused.extend(losers);
    };
    let base_snapshot = Snapshot {
        waves: Vec::new(),
        laws: Vec::new(),
    };
    let held = HeldCurve::new(&axis);
    let (before, base_slope) = begun.unwrap_or_else(|| (Before::new(&axis), 0.0));
    let last_ramp = if takes_slope(&outcome.accepted) {
        None
    } else {
        ramp::ramp(&axis)
    };
    let model = |snapshot: &Snapshot, fit: &Fit, r: f64| ModelAxis {
        name: signal.name.clone(),
        unit: signal.unit,
        mean,
        chain: signal.chain.clone(),
        coefficients: PerCoefficient {
            r,
            ..gain::coefficients(&fit.squared)
        },
        effects: law_effects(&axis.frame, snapshot, fit),
    };
    let expected = |model: &ModelAxis, with: &Snapshot| held.expected(&axis, model, with);
    let error = |model: &ModelAxis, with: &Snapshot| {
        let error = held.error_percent(&expected(model, with));
        error.map(|(error, _)| error)
    };
    let base = model(&base_snapshot, &base_fit, base_slope);
    let base_expected = expected(&base, &base_snapshot);
    let base_error = held.error_percent(&base_expected);
    let last_snapshot = Snapshot::of(&axis);
    let last_slope = slope(last_ramp);
    let stationary = model(&last_snapshot, &axis.fit, last_slope);
    let last_expected = expected(&stationary, &last_snapshot);
    let last_error = held.error_percent(&last_expected);
    let sizes = Sizes::new(&axis, &held, &stationary, &last_snapshot);
    let mut findings = Vec::new();
    for (one, nats) in outcome.accepted.iter().zip(nats) {
        let before = model(&one.without, &one.before, last_slope);
        let after = model(&one.with, &one.after, last_slope);
        findings.push(finding(
            one,
            Gain {
                heldout_nats: nats,
                allan_change_percent: sizes.change_percent(one),
                allan_error_percent_before: error(&before, &one.without),
                allan_error_percent_after: error(&after, &one.with),
            },
        ));
    }
    let mut net = axis.fit.squared.clone();
    let mut squares_sd = outcome.squares_sd;
    if let Some(white) = SEEN.iter().position(|one| *one == Letter::N) {
        let [even, even_sd] = even_density(&axis, &outcome.accepted);
        net[white] = (net[white] - even).max(0.0);
        squares_sd[white] = squares_sd[white].hypot(even_sd);
    }
    let whole = ModelAxis {
        coefficients: PerCoefficient {
            r: last_slope,
            ..gain::coefficients(&net)
        },
        effects: named_effects(&findings),
        ..stationary.clone()
    };
    let models = Models {
        base: &base,
        noise: &stationary,
        whole: &whole,
    };
    let held_out = held.beside(&base_expected, &last_expected);
    let simulate = options.simulate;
    let views = Views::new(&axis, before, models, held_out, &findings, mean, simulate);
    let passed = passed(&axis);
    let residual = residual(&axis.into_mended(), passed);
    let diagnosis = AxisDiagnosis {
        name: signal.name.clone(),
        unit: signal.unit,
        base: Base {
            model: base,
            discrepancies: outcome.discrepancies,
            allan_error_percent: base_error.map(|error| error.0),
            allan_error_sampling_percent: base_error.map(|error| error.1),
        },
        unexplained: outcome.unexplained,
        last: Final {
            model: whole,
            coefficients: PerCoefficient {
                r: last_ramp.as_ref().map(of_ramp).unwrap_or_default(),
                ..coefficients(&net, &squares_sd)
            },
            allan_error_percent: last_error.map(|error| error.0),
            allan_error_sampling_percent: last_error.map(|error| error.1),
        },
        findings,
        views,
    };
    Ok((diagnosis, residual))
}

/// What is left of an axis without the bands that were left out, where there are any: a tone that
/// wanders and that all axes see is no more a common noise than it is a noise.
fn passed(axis: &AxisState) -> Option<Series> {
    let seen = axis.whole();
    let kept = |k: usize| f64::from(u8::from(seen.density[k].is_finite()));
    let passed = || seen.whole.filtered(|k| kept(k).into());
    (!axis.apart.is_empty()).then(passed)
}

/// What is left of a record, or what of that `passed`; NaN where missing or masked.
fn residual(mended: &Mended, passed: Option<Series>) -> Vec<f32> {
    let left = mended.values();
    let Some(passed) = passed else {
        return left.iter().map(|&value| value as f32).collect();
    };
    let pairs = left.iter().zip(passed.iter());
    pairs
        .map(|(left, passed)| (passed + 0.0 * left) as f32)
        .collect()
}

/// Slope of a ramp that was told from none.
fn slope(ramp: Option<Ramp>) -> f64 {
    let told = ramp.filter(Ramp::identified);
    told.map_or(0.0, |ramp| ramp.per_s.abs())
}

/// Whether effects were taken out that go with a slope, so that what is left tells little of it.
fn takes_slope(accepted: &[Accepted]) -> bool {
    let slow = ["steps", "warmup", "thermal", "telegraph"];
    let mut waves = accepted.iter().filter(|one| one.law.is_none());
    waves.any(|one| slow.contains(&one.effect))
}

/// Gain of each effect on data that it was not fitted to. The halves are made where they are needed.
fn held_out(axis: &AxisState, accepted: &[Accepted]) -> Vec<Option<f64>> {
    let halves = OnceCell::new();
    let ordinates = OnceCell::new();
    let nats = accepted.iter().map(|one| {
        if one.nats.is_some() || one.changes_nothing() {
            return one.nats;
        }
        match one.law {
            Some(law) => {
                let ordinates = ordinates.get_or_init(|| Ordinates::new(axis));
                ordinates.as_ref()?.nats(law)
            }
            None => {
                let halves = halves.get_or_init(|| Halves::new(axis));
                halves.as_ref()?.nats(one)
            }
        }
    });
    nats.collect()
}

/// Effects as a model file has them, where the catalogue can make them.
fn named_effects(findings: &[Finding]) -> Vec<ModelEffect> {
    findings
        .iter()
        .filter_map(|finding| {
            let mut parameters: BTreeMap<String, f64> = finding
                .parameters
                .iter()
                .map(|(name, value)| (name.clone(), value.value))
                .collect();
            if finding.effect == "hum" {
                fill_harmonics(&mut parameters);
            }
            ModelEffect::new(&finding.effect, &parameters).ok()
        })
        .collect()
}

/// A model file numbers harmonics without holes: those that were not found are zero.
fn fill_harmonics(parameters: &mut BTreeMap<String, f64>) {
    let number = |name: &String| name.strip_prefix("amplitude_")?.parse().ok();
    let last: u32 = parameters.keys().filter_map(number).max().unwrap_or(0);
    for number in 1..=last {
        parameters
            .entry(format!("amplitude_{number}"))
            .or_insert(0.0);
    }
}

/// The laws of a snapshot with the sizes of a fit that has them.
fn law_effects(frame: &Frame, snapshot: &Snapshot, fit: &Fit) -> Vec<ModelEffect> {
    let laws = rounds::laws_of(snapshot);
    (0..laws.len())
        .filter_map(|which| {
            let law = &laws[which];
            let values = laws::sized(frame, &laws, which, fit);
            let parameters = law
                .effect
                .parameters(&values)
                .iter()
                .zip(&values)
                .map(|(parameter, value)| (parameter.name.to_string(), *value))
                .collect();
            ModelEffect::new(law.effect.name(), &parameters).ok()
        })
        .collect()
}

fn finding(one: &Accepted, gain: Gain) -> Finding {
    let kind: Option<&'static dyn Effect> = catalogue::find(one.effect);
    let values: Vec<f64> = kind.map_or_else(Vec::new, |kind| {
        let count = vec![0.0; one.parameters.len()];
        kind.parameters(&count)
            .iter()
            .map(|parameter| {
                one.parameters
                    .get(parameter.name.as_ref())
                    .map_or(0.0, |value| value.value)
            })
            .collect()
    });
    Finding {
        effect: one.effect.to_owned(),
        cause: kind.map_or_else(String::new, |kind| kind.meaning().to_owned()),
        check: kind.map_or_else(String::new, |kind| kind.check(&values)),
        parameters: one.parameters.clone(),
        p_value: one.p_value,
        rivals: one.rivals.clone(),
        gain,
        without: PerCoefficient::from_fn(|letter| coefficients_of(&one.before).get(letter).value),
    }
}
