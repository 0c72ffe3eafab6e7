//! One axis of a model: coefficients, signal chain, and effects of the catalogue with their parameters.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::catalogue::{self, CATALOGUE};
use super::effect::{self, Parameter, Part};
use super::kind::Kind;
use super::{Coefficient, PerCoefficient};
use crate::chain::Chain;
use crate::signal::Unit;

/// One axis of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelAxis {
    /// Name of the axis.
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
    /// The five coefficients, each in its own unit.
    #[serde(default)]
    pub coefficients: PerCoefficient<f64>,
    /// What there is besides.
    #[serde(default)]
    pub effects: Vec<ModelEffect>,
}

impl ModelAxis {
    /// True data rate over the nominal one.
    pub fn clock(&self) -> f64 {
        let ratio = |effect: &ModelEffect| match effect.part() {
            Part::Clock(ratio) => ratio,
            Part::Term(_) | Part::Distortion(_) | Part::Hold(_) | Part::Follows(_) => 1.0,
        };
        self.effects.iter().map(ratio).product()
    }

    /// Values a second by the nominal clock, of a record of `rate_hz` samples a second: as many, unless it is held.
    pub fn values_hz(&self, rate_hz: f64) -> f64 {
        let hold = |effect: &ModelEffect| match effect.part() {
            Part::Hold(values_hz) => Some(values_hz),
            Part::Term(_) | Part::Distortion(_) | Part::Clock(_) | Part::Follows(_) => None,
        };
        let slowest = self.effects.iter().filter_map(hold).reduce(f64::min);
        slowest.unwrap_or(rate_hz)
    }

    /// Whether data can be made of it at a nominal `rate_hz`.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub(super) fn check(&self, rate_hz: f64) -> Result<(), String> {
        if !self.mean.is_finite() {
            return Err(format!("mean is {}; expected a finite number", self.mean));
        }
        for coefficient in Coefficient::ALL {
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
                Part::Distortion(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => None,
            });
        let values_hz = self.values_hz(rate_hz);
        if values_hz > rate_hz {
            return Err(format!(
                "effect held: there are {values_hz} values a second; expected no more than the rate of {rate_hz}/s"
            ));
        }
        let rate_hz = self.clock() * values_hz;
        for (effect, lines) in lines {
            if let Some(line) = lines.iter().find(|line| line.f_hz >= 0.5 * rate_hz) {
                return Err(format!(
                    "effect {}: {} Hz is not below half the rate of {rate_hz}/s; give the \
                     frequency at which it is seen in the samples",
                    effect.kind().name(),
                    line.f_hz
                ));
            }
        }
        Ok(())
    }
}

/// An effect of the catalogue with its parameters.
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "NamedEffect", into = "NamedEffect")]
pub struct ModelEffect {
    kind: Kind,
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
        let values = effect::in_order(&*kind, parameters)?;
        Ok(Self { kind, values })
    }

    /// An effect with its parameters in the catalogue's order.
    ///
    /// # Errors
    /// In words, if they are too few or too many, or one is out of its range.
    pub fn of(kind: Kind, values: &[f64]) -> Result<Self, String> {
        let names = kind.parameters(values).into_iter();
        let names = names.map(|parameter| parameter.name.into_owned());
        let named: BTreeMap<String, f64> = names.zip(values.iter().copied()).collect();
        if named.len() != values.len() {
            let expected = kind.parameters(values).len();
            return Err(format!(
                "{kind}: {} parameters; expected {expected}",
                values.len()
            ));
        }
        let values = effect::in_order(&*kind, &named)?;
        Ok(Self { kind, values })
    }

    /// Which effect of the catalogue it is.
    pub const fn kind(&self) -> Kind {
        self.kind
    }

    /// Parameters of the effect, in the order of its values.
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
        let known = effect.parameters().into_iter().zip(&effect.values);
        // What may be left out is, where it is zero.
        let written = known.filter(|(one, value)| !one.optional || **value != 0.0);
        Self {
            effect: effect.kind.name().to_owned(),
            parameters: written
                .map(|(one, value)| (String::from(one.name), *value))
                .collect(),
        }
    }
}

impl PartialEq for ModelEffect {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind && self.values == other.values
    }
}

impl std::fmt::Debug for ModelEffect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{:?}", self.kind.name(), self.values)
    }
}
