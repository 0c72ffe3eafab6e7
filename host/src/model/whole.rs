//! A whole model: axes, and how their random numbers are correlated.

use std::collections::HashSet;

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::axis::ModelAxis;
use super::correlation;
use super::published::{PublishedAxis, RATE_HZ};
use crate::plain::{PLAIN, is_plain};
use crate::signal::{POSSIBLE_RATE, POSSIBLE_RATE_HZ, Unit};

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
    /// One model an axis.
    pub axes: Vec<ModelAxis>,
    /// Correlation of the random numbers behind K, B, N and Q between the axes, one row an axis:
    /// symmetric, 1 on the diagonal, no negative eigenvalue. `None` for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correlation: Option<Vec<Vec<f64>>>,
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
        if !POSSIBLE_RATE_HZ.contains(&self.rate_hz) {
            return Err(format!(
                "rate_hz is {:?}; expected samples a second, {POSSIBLE_RATE}",
                self.rate_hz
            ));
        }
        if self.axes.is_empty() {
            return Err("axes is empty; expected one axis or more".to_owned());
        }
        let mut names = HashSet::new();
        for (place, axis) in self.axes.iter().enumerate() {
            if !is_plain(&axis.name) {
                let name = axis.name.escape_debug();
                return Err(format!("axis {place} is called `{name}`; expected {PLAIN}"));
            }
            if !names.insert(&axis.name) {
                return Err(format!("two axes are called `{}`", axis.name));
            }
            axis.check(self.rate_hz)
                .map_err(|problem| format!("axis {}: {problem}", axis.name))?;
        }
        self.mixing().map(drop)
    }

    /// How the random numbers of the axes are mixed: the lower Cholesky factor of the
    /// correlation, one row an axis; the unit matrix where there is none.
    ///
    /// # Errors
    /// In words, if the correlation is none.
    pub fn mixing(&self) -> Result<DMatrix<f64>, String> {
        correlation::mixing(self.correlation.as_deref(), self.axes.len())
    }
}
