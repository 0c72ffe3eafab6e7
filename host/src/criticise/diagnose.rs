//! From a record in memory to what is wrong with its model and why.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use super::axis::AxisState;
use super::codes;
use super::coherence::{self, Common};
use super::finding::{AxisDiagnosis, Base, Coefficient, Final, Finding, Gain, Value};
use super::frame::Frame;
use super::gain::laws::Ordinates;
use super::gain::{self, Halves, HeldCurve};
use super::impulses::middle_spread;
use super::laws;
use super::rounds::{self, Accepted, CodeFindings, Options, Snapshot};
use super::samples::{AxisSamples, Samples};
use crate::fit::likelihood::Fit;
use crate::fit::likelihood::components::SEEN;
use crate::model::catalogue;
use crate::model::effect::Effect;
use crate::model::whole::{ModelAxis, ModelEffect};
use crate::model::{Coefficient as Letter, PerCoefficient};
use crate::signal::Axis;
use crate::source::Values;

/// Samples below which no spectrum is worth the name.
const LEAST: usize = 1 << 13;

/// Step of a grid over the short-term noise below which chance repeats can be foretold: with few
/// steps in the noise its law, which a correlation of neighbours or a dither changes, decides.
const SPANNED: f64 = 0.25;

/// Standard deviations of a one-sided 5 % test, and of a 95 % interval.
const ONE_SIDED: f64 = 1.644_854;
const TWO_SIDED: f64 = 1.959_964;

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
    /// All the same, or nothing to fit.
    #[error("axis {axis}: all samples are the same, there is no noise to diagnose")]
    Constant {
        /// Name of the axis.
        axis: String,
    },
}

/// Diagnoses all axes, and what they have in common. `progress` is told each axis that is done.
///
/// # Errors
/// [`Refused`] where an axis holds too little.
pub fn diagnose(
    samples: &Samples,
    options: &Options,
    mut progress: impl FnMut(usize),
) -> Result<Vec<AxisDiagnosis>, Refused> {
    let (mut axes, mut residuals) = (Vec::new(), Vec::new());
    for number in 0..samples.axes.len() {
        let (axis, residual) = diagnose_axis(samples, number, options)?;
        axes.push(axis);
        residuals.push(residual);
        progress(number);
    }
    for common in coherence::common(&residuals, samples.signal.rate_hz, options.level()) {
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
    samples: &Samples,
    number: usize,
    options: &Options,
) -> Result<(AxisDiagnosis, Vec<f32>), Refused> {
    let signal = &samples.signal.axes[number];
    let record = &samples.axes[number];
    let rate_hz = samples.signal.rate_hz;
    let (measured, mean) = record.centred(signal.scale);
    let good = measured.iter().filter(|value| value.is_finite()).count();
    if good < LEAST {
        return Err(Refused::TooShort {
            axis: signal.name.clone(),
            samples: good,
        });
    }
    let constant = || Refused::Constant {
        axis: signal.name.clone(),
    };
    let mean = mean - signal.zero * signal.scale;
    let values = code_findings(record, signal, options.level(), &measured, mean);
    let mut refused: Vec<&'static str> = Vec::new();
    let (axis, base_fit, outcome, nats) = loop {
        let mut axis = AxisState::new(measured.clone(), rate_hz, signal.chain.as_ref())
            .ok_or_else(constant)?;
        let base_fit = axis.fit.clone();
        let outcome = rounds::run(&mut axis, options, &values, &refused).ok_or_else(constant)?;
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
    let model = |snapshot: &Snapshot, fit: &Fit| ModelAxis {
        name: signal.name.clone(),
        unit: signal.unit,
        mean,
        chain: signal.chain.clone(),
        coefficients: gain::coefficients(&fit.squared),
        effects: law_effects(&axis.frame, snapshot, fit),
    };
    let error =
        |model: &ModelAxis, snapshot: &Snapshot| gain::allan_error(&axis, &held, model, snapshot);
    let base = model(&base_snapshot, &base_fit);
    let base_error = error(&base, &base_snapshot);
    let last_snapshot = outcome
        .accepted
        .last()
        .map_or_else(|| base_snapshot.clone(), |one| one.with.clone());
    let stationary = model(&last_snapshot, &axis.fit);
    let last_error = error(&stationary, &last_snapshot);
    let mut findings = Vec::new();
    for (index, one) in outcome.accepted.iter().enumerate() {
        let before = model(&one.without, &one.before);
        let after_fit = outcome
            .accepted
            .get(index + 1)
            .map_or(&axis.fit, |next| &next.before);
        let after = model(&one.with, after_fit);
        findings.push(finding(
            one,
            Gain {
                heldout_nats: nats[index],
                allan_error_percent_before: error(&before, &one.without).map(|error| error.0),
                allan_error_percent_after: error(&after, &one.with).map(|error| error.0),
            },
        ));
    }
    let named = named_effects(&findings);
    let residual = axis.mended.values().iter().map(|&v| v as f32).collect();
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
            model: ModelAxis {
                effects: named,
                ..stationary
            },
            coefficients: coefficients(&axis.fit),
            allan_error_percent: last_error.map(|error| error.0),
            allan_error_sampling_percent: last_error.map(|error| error.1),
        },
        findings,
    };
    Ok((diagnosis, residual))
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
            let parameters = finding
                .parameters
                .iter()
                .map(|(name, value)| (name.clone(), value.value))
                .collect();
            ModelEffect::new(&finding.effect, &parameters).ok()
        })
        .collect()
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
        without: PerCoefficient::from_fn(|letter| coefficients(&one.before).get(letter).value),
    }
}

/// The coefficients of a fit with intervals by its covariance.
fn coefficients(fit: &Fit) -> PerCoefficient<Coefficient> {
    PerCoefficient::from_fn(|letter| {
        let Some(place) = SEEN.iter().position(|seen| *seen == letter) else {
            return Coefficient::default();
        };
        let (squared, sd) = (fit.squared[place], fit.covariance[(place, place)].sqrt());
        let root = |square: f64| square.max(0.0).sqrt();
        let identified = squared > ONE_SIDED * sd && letter != Letter::R;
        Coefficient {
            value: identified.then(|| root(squared)),
            lo: identified.then(|| root(squared - TWO_SIDED * sd)),
            hi: identified.then(|| root(squared + TWO_SIDED * sd)),
            identified,
            upper: Some(root(squared + ONE_SIDED * sd)),
        }
    })
}

/// What the values themselves say.
fn code_findings(
    record: &AxisSamples,
    signal: &Axis,
    level: f64,
    measured: &[f64],
    mean: f64,
) -> CodeFindings {
    let declared = matches!(record.raw(), Values::Codes(_)).then_some(signal.scale);
    let grid = codes::grid(measured);
    let increments: Vec<f64> = measured
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| step.is_finite())
        .collect();
    // From the spread of increments, so that wander does not count.
    let noise = middle_spread(&increments).max(
        increments
            .iter()
            .map(|step| step * step)
            .sum::<f64>()
            .sqrt()
            / (increments.len() as f64).sqrt()
            * 0.5,
    ) / std::f64::consts::SQRT_2;
    let coarse = grid.filter(|&step| {
        let coarser = declared.is_none_or(|declared| step > 1.5 * declared.abs());
        coarser && step > 0.25 * noise
    });
    // On a grid that the noise does not span, repeats are no news.
    let spanned = grid.is_none_or(|step| step < SPANNED * noise);
    let stale = codes::stale(measured, grid, level).filter(|_| spanned);
    let repeats = || {
        (1..measured.len())
            .filter(|&n| measured[n] == measured[n - 1])
            .collect()
    };
    CodeFindings {
        stale: stale.map(|stale| (stale, repeats())),
        clipping: codes::clipping(measured, grid, level)
            .into_iter()
            .map(|one| {
                let reached = |value: f64| one.side * value >= one.side * one.level;
                let places = (0..measured.len()).filter(|&n| reached(measured[n]));
                let about_zero = codes::Clipping {
                    level: one.level + mean,
                    ..one
                };
                (about_zero, places.collect())
            })
            .collect(),
        coarse,
        largest: measured
            .iter()
            .filter(|value| value.is_finite())
            .fold(mean.abs(), |most, value| most.max((value + mean).abs())),
    }
}
