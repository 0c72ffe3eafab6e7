//! What a record says of a kind of effect that was suspected and not found.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::diagnosis::result::rival::Rival;
use crate::model::kind::Kind;

/// A kind that was suspected and not found. Neither candidate nor limits: for such a kind none are computed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suspicion {
    /// Which effect of the catalogue.
    pub effect: Kind,
    /// The likeliest of its kind beside the last model; `None` where the spectrum's shape has no candidate, as of a
    /// kind that is not looked for there.
    pub best: Option<Best>,
    /// How large it may be, at each of some shapes; empty for a kind that has no size at one shape.
    pub limits: Vec<Limit>,
}

/// The likeliest effect of a kind that was not found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Best {
    /// Its parameters, in the units of the catalogue.
    pub parameters: BTreeMap<String, f64>,
    /// Gain in log-likelihood over the last model, nats.
    pub gain_nats: f64,
    /// Gain that a name would have needed at least, nats.
    pub needed_nats: f64,
    /// Probability of as large a gain where it is absent, the search of its shapes included.
    pub p_value: f64,
    /// Other effects with the same spectrum, with the logarithm of the odds for the suspect.
    pub rivals: Vec<Rival>,
}

/// How large an effect of one shape may be.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Limit {
    /// Name of the parameter that is its size.
    pub size: String,
    /// Its one-sided 95 % bound, in the unit of the catalogue; `None` where the record sets none.
    pub upper: Option<f64>,
    /// All its other parameters.
    pub at: BTreeMap<String, f64>,
}
