//! The file that holds a model, and what can be wrong with it.
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

use std::path::Path;

use serde::Deserialize;

use super::axis::ModelAxis;
use super::published::PublishedAxis;
use super::whole::{Model, SCHEMA};

/// A model that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct ModelError {
    /// Name of the file.
    pub place: String,
    /// What was found, what was expected, and what to do.
    pub problem: String,
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

impl Model {
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
}
