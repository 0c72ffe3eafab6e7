//! An effect with what is known of its parameters.

use std::collections::BTreeMap;

use super::value::Value;
use crate::model::effect::Parameter;
use crate::model::kind::Kind;

/// An effect of the catalogue with what is known of its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Which effect.
    pub kind: Kind,
    /// In the catalogue's order; `None` where the record does not determine one, as of a harmonic that was not
    /// found. Empty for a law of the noise until the last fit has its values.
    pub values: Vec<Option<Value>>,
}

impl Estimate {
    /// An effect with all of its parameters known.
    pub fn new(kind: Kind, values: impl IntoIterator<Item = Value>) -> Self {
        Self {
            kind,
            values: values.into_iter().map(Some).collect(),
        }
    }

    /// A law of the noise, whose values the last fit will have.
    pub const fn of_law(kind: Kind) -> Self {
        Self {
            kind,
            values: Vec::new(),
        }
    }

    /// The parameters without their intervals, zero where not known.
    pub fn plain(&self) -> Vec<f64> {
        let plain = |value: &Option<Value>| value.map_or(0.0, |value| value.value);
        self.values.iter().map(plain).collect()
    }

    /// The parameters that are known, in the catalogue's order.
    pub fn known(&self) -> impl Iterator<Item = (Parameter, Value)> {
        let parameters = self.kind.parameters(&self.plain()).into_iter();
        let pairs = parameters.zip(&self.values);
        pairs.filter_map(|(parameter, value)| Some((parameter, (*value)?)))
    }

    /// The same by their names.
    pub fn named(&self) -> BTreeMap<String, Value> {
        let pairs = self.known();
        pairs
            .map(|(parameter, value)| (parameter.name.into_owned(), value))
            .collect()
    }
}
