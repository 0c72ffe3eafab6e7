//! What else explains the same.

use serde::Serialize;

use crate::model::kind::Kind;

/// Another effect that explains the same.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rival {
    /// Which effect of the catalogue it is.
    pub effect: Kind,
    /// Natural logarithm of the odds for the finding against it.
    pub log_odds: f64,
}
