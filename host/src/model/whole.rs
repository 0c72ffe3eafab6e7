//! A whole model: axes with coefficients, effects and signal chain, and the file that holds it.
//!
//! ```json
//! { "schema": 1, "rate_hz": 2000.0,
//!   "axes": [ { "name": "X", "unit": "m/s^2", "mean": 9.8, "chain": "ads1281:linear+400hz",
//!               "coefficients": { "R": 0, "K": 3.6e-5, "B": 5.5e-5, "N": 1.05e-4, "Q": 2.25e-4 },
//!               "effects": [ { "effect": "sinusoid",
//!                              "parameters": { "f_hz": 50.0, "amplitude": 1e-3 } } ] } ],
//!   "correlation": [[1.0]] }
//! ```
//!
//! `mean`, `chain`, `coefficients` (each of them), `effects` and `correlation` may be left out.
//! The JSON of a diagnosis is read as well, for the models that it ends with.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::PerCoefficient;
use super::catalogue::{self, CATALOGUE};
use super::effect::{self, Effect, Parameter, Part};
use super::law::Law;
use super::published::{PublishedAxis, RATE_HZ};
use crate::chain::Chain;
use crate::signal::Unit;

/// Version of the file.
pub const SCHEMA: u32 = 1;

/// A noise model of some axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Version of the file, [`SCHEMA`].
    pub schema: u32,
    /// Samples a second.
    pub rate_hz: f64,
    /// The axes.
    pub axes: Vec<ModelAxis>,
    /// Correlation of the random numbers behind K, B, N and Q between the axes, one row an axis:
    /// symmetric, 1 on the diagonal, no negative eigenvalue. `None` for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correlation: Option<Vec<Vec<f64>>>,
}

/// The part of a diagnosis that is a model.
#[derive(Deserialize)]
struct Diagnosed {
    source: DiagnosedSource,
    axes: Vec<DiagnosedAxis>,
}

#[derive(Deserialize)]
struct DiagnosedSource {
    rate_hz: f64,
}

#[derive(Deserialize)]
struct DiagnosedAxis {
    #[serde(rename = "final")]
    last: DiagnosedFinal,
}

#[derive(Deserialize)]
struct DiagnosedFinal {
    model: ModelAxis,
}

impl Diagnosed {
    fn model(self) -> Model {
        Model {
            schema: SCHEMA,
            rate_hz: self.source.rate_hz,
            axes: self.axes.into_iter().map(|axis| axis.last.model).collect(),
            correlation: None,
        }
    }
}

/// One axis of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelAxis {
    /// Its name.
    pub name: String,
    /// Unit of the signal.
    #[serde(default)]
    pub unit: Unit,
    /// Mean of the signal.
    #[serde(default)]
    pub mean: f64,
    /// Signal chain behind the terms.
    #[serde(default)]
    pub chain: Option<Chain>,
    /// The five coefficients.
    #[serde(default)]
    pub coefficients: PerCoefficient<f64>,
    /// What there is besides.
    #[serde(default)]
    pub effects: Vec<ModelEffect>,
}

/// An effect of the catalogue with its parameters.
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "NamedEffect", into = "NamedEffect")]
pub struct ModelEffect {
    kind: &'static dyn Effect,
    values: Vec<f64>,
}

/// An effect as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NamedEffect {
    effect: String,
    parameters: BTreeMap<String, f64>,
}

impl ModelEffect {
    /// The effect `name` with its parameters by name.
    ///
    /// # Errors
    /// In words, if there is no such effect, or a parameter is missing, unknown or out of range.
    pub fn new(name: &str, parameters: &BTreeMap<String, f64>) -> Result<Self, String> {
        let kind = catalogue::find(name).ok_or_else(|| {
            let names: Vec<&str> = CATALOGUE.iter().map(|one| one.name()).collect();
            format!("no effect `{name}`; known are {}", names.join(", "))
        })?;
        let values = effect::in_order(kind, parameters)?;
        Ok(Self { kind, values })
    }

    /// Which effect.
    pub const fn kind(&self) -> &'static dyn Effect {
        self.kind
    }

    /// Its parameters.
    pub fn parameters(&self) -> Vec<Parameter> {
        self.kind.parameters(&self.values)
    }

    /// The values of the parameters, in their order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// What it adds to the model.
    pub fn part(&self) -> Part {
        self.kind.part(&self.values)
    }
}

impl TryFrom<NamedEffect> for ModelEffect {
    type Error = String;

    fn try_from(named: NamedEffect) -> Result<Self, String> {
        Self::new(&named.effect, &named.parameters)
    }
}

impl From<ModelEffect> for NamedEffect {
    fn from(effect: ModelEffect) -> Self {
        let names = effect.parameters().into_iter().map(|one| one.name);
        Self {
            effect: effect.kind.name().to_owned(),
            parameters: names.map(String::from).zip(effect.values).collect(),
        }
    }
}

impl PartialEq for ModelEffect {
    fn eq(&self, other: &Self) -> bool {
        self.kind.name() == other.kind.name() && self.values == other.values
    }
}

impl std::fmt::Debug for ModelEffect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{:?}", self.kind.name(), self.values)
    }
}

impl Model {
    /// The published model: one axis, or all three where `axis` is `None`.
    pub fn published(axis: Option<PublishedAxis>) -> Self {
        let axes = PublishedAxis::ALL
            .into_iter()
            .filter(|&one| axis.is_none_or(|axis| axis == one))
            .map(|one| ModelAxis {
                name: one.name().to_owned(),
                unit: Unit::MetrePerSecondSquared,
                mean: 0.0,
                chain: None,
                coefficients: one.coefficients(),
                effects: Vec::new(),
            });
        Self {
            schema: SCHEMA,
            rate_hz: RATE_HZ,
            axes: axes.collect(),
            correlation: None,
        }
    }

    /// Reads a model: `published`, `published:X` (Y, Z), or the name of a model file.
    ///
    /// # Errors
    /// [`ModelError`] if there is no such file, or it is no model.
    pub fn open(name: &str) -> Result<Self, ModelError> {
        if name == "published" {
            return Ok(Self::published(None));
        }
        let axis = |one: &PublishedAxis| name.strip_prefix("published:") == Some(one.name());
        if let Some(axis) = PublishedAxis::ALL.into_iter().find(axis) {
            return Ok(Self::published(Some(axis)));
        }
        let error = |problem: String| ModelError {
            place: name.to_owned(),
            problem,
        };
        let text = std::fs::read_to_string(Path::new(name)).map_err(|cause| {
            error(match cause.kind() {
                std::io::ErrorKind::NotFound => "no such model; published, published:X, \
                                                 published:Y, published:Z, or a JSON file"
                    .to_owned(),
                _ => format!("cannot be read: {cause}"),
            })
        })?;
        Self::from_json(&text).map_err(error)
    }

    /// Reads the text of a model file, or of a diagnosis.
    ///
    /// # Errors
    /// In words: the place in the text, what was found and what was expected.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let model = match serde_json::from_str::<Diagnosed>(text) {
            Ok(diagnosed) => diagnosed.model(),
            Err(_) => serde_json::from_str(text).map_err(|cause| cause.to_string())?,
        };
        model.check()?;
        Ok(model)
    }

    /// Whether it is a model that data can be made of.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub fn check(&self) -> Result<(), String> {
        if self.schema != SCHEMA {
            return Err(format!(
                "schema {} of model files is not known; expected {SCHEMA}",
                self.schema
            ));
        }
        if !(self.rate_hz > 0.0 && self.rate_hz.is_finite()) {
            return Err(format!(
                "rate_hz is {}; expected samples a second, a number above zero",
                self.rate_hz
            ));
        }
        if self.axes.is_empty() {
            return Err("axes is empty; expected one axis or more".to_owned());
        }
        let mut names = HashSet::new();
        for axis in &self.axes {
            if !names.insert(&axis.name) {
                return Err(format!("two axes are called `{}`", axis.name));
            }
            axis.check(self.rate_hz)
                .map_err(|problem| format!("axis {}: {problem}", axis.name))?;
        }
        self.mixing().map(|_| ())
    }

    /// How the random numbers of the axes are mixed: the lower Cholesky factor of the
    /// correlation, one row an axis; the unit matrix where there is none.
    ///
    /// # Errors
    /// In words, if the correlation is none.
    pub fn mixing(&self) -> Result<DMatrix<f64>, String> {
        let n = self.axes.len();
        let Some(rows) = &self.correlation else {
            return Ok(DMatrix::identity(n, n));
        };
        if rows.len() != n || rows.iter().any(|row| row.len() != n) {
            return Err(format!(
                "correlation is no matrix of {n} by {n}, one row an axis"
            ));
        }
        let matrix = DMatrix::from_fn(n, n, |i, j| rows[i][j]);
        let bounded = matrix.iter().all(|one| one.abs() <= 1.0);
        let unit = matrix.diagonal().iter().all(|&one| one == 1.0);
        if !bounded || !unit || matrix != matrix.transpose() {
            return Err(
                "correlation is not symmetric with 1 on the diagonal and -1 to 1 elsewhere"
                    .to_owned(),
            );
        }
        semidefinite_factor(&matrix).ok_or_else(|| {
            "correlation has a negative eigenvalue: no three signals are correlated so".to_owned()
        })
    }
}

/// The lower factor `L` of `matrix = L L'`; a pivot of zero is admitted.
fn semidefinite_factor(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    const ROUNDING: f64 = 1e-12;
    let n = matrix.nrows();
    let mut factor = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            let rest: f64 =
                matrix[(i, j)] - (0..j).map(|k| factor[(i, k)] * factor[(j, k)]).sum::<f64>();
            factor[(i, j)] = if i == j {
                if rest < -ROUNDING {
                    return None;
                }
                rest.max(0.0).sqrt()
            } else if factor[(j, j)] > 0.0 {
                rest / factor[(j, j)]
            } else if rest.abs() > ROUNDING {
                return None;
            } else {
                0.0
            };
        }
    }
    Some(factor)
}

impl ModelAxis {
    /// What data of this axis should look like.
    pub fn law(&self, rate_hz: f64) -> Law {
        Law::new(self, rate_hz)
    }

    /// True data rate over the nominal one.
    pub fn clock(&self) -> f64 {
        let ratio = |effect: &ModelEffect| match effect.part() {
            Part::Clock(ratio) => ratio,
            Part::Term(_) | Part::Distortion(_) | Part::Follows(_) => 1.0,
        };
        self.effects.iter().map(ratio).product()
    }

    fn check(&self, rate_hz: f64) -> Result<(), String> {
        if !self.mean.is_finite() {
            return Err(format!("mean is {}; expected a finite number", self.mean));
        }
        for coefficient in super::Coefficient::ALL {
            let value = *self.coefficients.get(coefficient);
            if !value.is_finite() {
                return Err(format!(
                    "coefficient {} is {value}; expected a finite number",
                    coefficient.symbol()
                ));
            }
        }
        let lines = self
            .effects
            .iter()
            .filter_map(|effect| match effect.part() {
                Part::Term(term) => Some((effect, term.lines())),
                Part::Distortion(_) | Part::Clock(_) | Part::Follows(_) => None,
            });
        let rate_hz = self.clock() * rate_hz;
        for (effect, lines) in lines {
            if let Some(line) = lines.iter().find(|line| line.f_hz >= 0.5 * rate_hz) {
                return Err(format!(
                    "effect {}: {} Hz is not below half the rate of {rate_hz}/s; give the \
                     frequency at which it is seen in the samples",
                    effect.kind.name(),
                    line.f_hz
                ));
            }
        }
        Ok(())
    }
}

/// A model that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct ModelError {
    /// The file.
    pub place: String,
    /// What was found, what was expected, and what to do.
    pub problem: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = r#"{ "schema": 1, "rate_hz": 2000.0,
        "axes": [ { "name": "X", "unit": "m/s^2", "mean": 9.8, "chain": "ads1281:linear+400hz",
                    "coefficients": { "K": 3.6e-5, "N": 1e-4 },
                    "effects": [
                      { "effect": "sinusoid", "parameters": { "f_hz": 50, "amplitude": 1e-3 } },
                      { "effect": "markov", "parameters": { "time_s": 0.1, "amplitude": 2e-4 } } ] },
                  { "name": "Y", "unit": "m/s^2" } ],
        "correlation": [[1, 0.3], [0.3, 1]] }"#;

    #[test]
    fn reads_back_what_it_writes() {
        let model = Model::from_json(FILE).expect("a model");
        assert_eq!(model.axes[0].effects[1].values(), [2e-4, 0.1]);
        let text = serde_json::to_string(&model).expect("serialisable");
        assert_eq!(Model::from_json(&text), Ok(model));
    }

    #[test]
    fn a_diagnosis_holds_a_model() {
        let mut model = Model::from_json(FILE).expect("a model");
        model.correlation = None;
        let axes: Vec<_> = model
            .axes
            .iter()
            .map(|axis| serde_json::json!({ "name": axis.name, "final": { "model": axis } }))
            .collect();
        let diagnosis = serde_json::json!({
            "schema": 1, "source": { "rate_hz": model.rate_hz, "file": "x" }, "axes": axes
        });
        assert_eq!(Model::from_json(&diagnosis.to_string()), Ok(model));
    }

    #[test]
    fn says_what_is_wrong_with_a_file() {
        for (from, to, expected) in [
            (
                "\"sinusoid\"",
                "\"sine\"",
                "no effect `sine`; known are sinusoid, markov",
            ),
            (
                "\"f_hz\"",
                "\"f\"",
                "sinusoid: no parameter `f`; expected f_hz, amplitude",
            ),
            (
                "\"time_s\": 0.1, ",
                "",
                "parameter `time_s` (correlation time) is missing",
            ),
            (
                "\"f_hz\": 50",
                "\"f_hz\": -1",
                "expected a number above zero",
            ),
            (
                "\"f_hz\": 50",
                "\"f_hz\": 1000",
                "axis X: effect sinusoid: 1000 Hz is not below",
            ),
            ("400hz", "400", "`400` is no part of a signal chain"),
            ("\"K\"", "\"L\"", "unknown field `L`"),
            ("\"Y\"", "\"X\"", "two axes are called `X`"),
            ("[0.3, 1]", "[0.4, 1]", "not symmetric"),
            (", [0.3, 1]", "", "2 by 2"),
            ("2000.0", "0", "rate_hz is 0"),
            ("\"schema\": 1", "\"schema\": 2", "schema 2"),
        ] {
            assert!(FILE.contains(from), "{from}");
            let error = Model::from_json(&FILE.replacen(from, to, 1)).expect_err(to);
            assert!(error.contains(expected), "{to}: {error}");
        }
    }

    #[test]
    fn impossible_correlations_are_refused() {
        let three = |r12: f64, r13: f64, r23: f64| Model {
            correlation: Some(vec![
                vec![1.0, r12, r13],
                vec![r12, 1.0, r23],
                vec![r13, r23, 1.0],
            ]),
            ..Model::published(None)
        };
        assert!(three(0.9, 0.9, -0.9).mixing().is_err());
        // Two axes that are one and the same are possible.
        let factor = three(1.0, 0.5, 0.5).mixing().expect("a correlation");
        let product = &factor * factor.transpose();
        assert!((product[(2, 1)] - 0.5).abs() < 1e-15 && (product[(2, 2)] - 1.0).abs() < 1e-15);
    }
}
