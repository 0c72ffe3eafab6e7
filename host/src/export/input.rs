//! What is exported: a model, or what an analysis or a diagnosis found.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use crate::chain::Chain;
use crate::model::axis::ModelAxis;
use crate::model::file::ModelError;
use crate::model::published::DURATION_S;
use crate::model::whole::{Model, SCHEMA};
use crate::model::{Coefficient, PerCoefficient};
use crate::plain::on_a_line;
use crate::signal::Unit;

/// A model and what is known about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// Where it comes from, for people, on one line.
    pub name: String,
    /// The model. A coefficient that analysis or diagnosis did not resolve from zero is zero.
    pub model: Model,
    /// 95 % bounds of the coefficients that could not be resolved from zero, one set an axis.
    pub bounds: Vec<PerCoefficient<Option<f64>>>,
    /// Longest averaging time that matters, seconds.
    pub longest_s: f64,
}

/// The part of an analysis that is a model.
#[derive(Deserialize)]
struct Analysis {
    source: AnalysisSource,
    axes: Vec<AnalysisAxis>,
}

#[derive(Deserialize)]
struct AnalysisSource {
    rate_hz: f64,
    duration_s: f64,
}

#[derive(Deserialize)]
struct AnalysisAxis {
    name: String,
    unit: Unit,
    mean: Option<f64>,
    chain: Option<Chain>,
    fits: AnalysisFits,
}

#[derive(Deserialize)]
struct AnalysisFits {
    likelihood: Option<BTreeMap<String, Value>>,
    weighted: Option<BTreeMap<String, Value>>,
}

/// The part of a diagnosis that says what it could tell from zero.
#[derive(Deserialize)]
struct Diagnosed {
    axes: Vec<DiagnosedAxis>,
}

#[derive(Deserialize)]
struct DiagnosedAxis {
    #[serde(rename = "final")]
    last: DiagnosedFinal,
}

#[derive(Deserialize)]
struct DiagnosedFinal {
    coefficients: BTreeMap<String, DiagnosedCoefficient>,
}

#[derive(Deserialize)]
struct DiagnosedCoefficient {
    identified: bool,
    upper: Option<f64>,
}

/// Takes out of the `model` of a diagnosis the coefficients that it could not resolve from zero, which
/// its fit gives a value all the same; their bounds, axis by axis.
fn leave_out(model: &mut Model, diagnosed: Option<Diagnosed>) -> Vec<PerCoefficient<Option<f64>>> {
    let mut bounds = vec![PerCoefficient::default(); model.axes.len()];
    let told = diagnosed.map_or_else(Vec::new, |diagnosed| diagnosed.axes);
    for ((axis, bounds), told) in model.axes.iter_mut().zip(&mut bounds).zip(told) {
        let unresolved = |one: Coefficient| {
            let told = told.last.coefficients.get(one.symbol());
            told.filter(|told| !told.identified)
        };
        *bounds = PerCoefficient::from_fn(|one| unresolved(one)?.upper);
        axis.coefficients = PerCoefficient::from_fn(|one| match unresolved(one) {
            Some(_) => 0.0,
            None => *axis.coefficients.get(one),
        });
    }
    bounds
}

impl Input {
    /// Opens `published`, `published:X` (Y, Z), a model file, or the JSON of `inm analyze` or
    /// `inm diagnose`.
    ///
    /// # Errors
    /// [`ModelError`] if it is none of them.
    pub fn open(name: &str) -> Result<Self, ModelError> {
        let mut longest_s = DURATION_S / 2.0;
        let mut diagnosed = None;
        if let Ok(text) = std::fs::read_to_string(name) {
            let value = serde_json::from_str(&text).unwrap_or(Value::Null);
            if value.pointer("/axes/0/fits").is_some() {
                let error = |problem| ModelError {
                    place: name.to_owned(),
                    problem,
                };
                return Self::from_analysis(name, &text).map_err(error);
            }
            let duration_s = value.pointer("/source/duration_s").and_then(Value::as_f64);
            longest_s = duration_s.map_or(longest_s, |duration_s| duration_s / 2.0);
            diagnosed = serde_json::from_value(value).ok();
        }
        let mut model = Model::open(name)?;
        Ok(Self {
            name: on_a_line(name).into_owned(),
            bounds: leave_out(&mut model, diagnosed),
            model,
            longest_s,
        })
    }

    /// Sets the longest averaging time that matters, seconds.
    ///
    /// # Errors
    /// In words, if it is shorter than a sample or no number.
    pub fn set_longest(&mut self, longest_s: f64) -> Result<(), String> {
        let shortest_s = 1.0 / self.model.rate_hz;
        // Written so that NaN is refused as well.
        if longest_s >= shortest_s && longest_s.is_finite() {
            self.longest_s = longest_s;
            Ok(())
        } else {
            Err(format!(
                "--longest {longest_s}: expected a time in seconds, at least one sample \
                 ({shortest_s} s)"
            ))
        }
    }

    /// Takes the likelihood fit of an analysis where there is one, else the weighted fit.
    fn from_analysis(name: &str, text: &str) -> Result<Self, String> {
        let analysis: Analysis = serde_json::from_str(text)
            .map_err(|cause| format!("not an analysis of schema 1: {cause}"))?;
        let mut bounds = Vec::new();
        let mut axes = Vec::new();
        for axis in analysis.axes {
            let fit = axis.fits.likelihood.or(axis.fits.weighted).ok_or_else(|| {
                format!(
                    "axis {} has no fit: the record is too short; analyse a longer one",
                    axis.name
                )
            })?;
            let number = |coefficient: Coefficient, field| {
                fit.get(coefficient.symbol())
                    .and_then(|one| one.get(field))
                    .and_then(Value::as_f64)
            };
            // The likelihood fit says so; the weighted one gives a value to what it cannot resolve
            // from zero, with an interval that begins there.
            let told = |one: Coefficient| {
                fit.get(one.symbol())
                    .and_then(|one| one.get("identified"))
                    .and_then(Value::as_bool)
                    .unwrap_or(number(one, "lo") != Some(0.0))
            };
            let value = |one| number(one, "value").filter(|_| told(one));
            // The weighted fit's bound is the end of its interval.
            let bound = |one| number(one, "upper").or_else(|| number(one, "hi"));
            bounds.push(PerCoefficient::from_fn(|one| {
                bound(one).filter(|_| value(one).is_none())
            }));
            axes.push(ModelAxis {
                name: axis.name,
                unit: axis.unit,
                mean: axis.mean.unwrap_or(0.0),
                chain: axis.chain,
                coefficients: PerCoefficient::from_fn(|one| value(one).unwrap_or(0.0)),
                effects: Vec::new(),
            });
        }
        let model = Model {
            schema: SCHEMA,
            rate_hz: analysis.source.rate_hz,
            axes,
            correlation: None,
        };
        model.check()?;
        Ok(Self {
            name: on_a_line(name).into_owned(),
            model,
            bounds,
            longest_s: analysis.source.duration_s / 2.0,
        })
    }
}
