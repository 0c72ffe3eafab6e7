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

/// Odds below which a record does not decide between two names: what is less likely than one in twenty lies outside the
/// 95 % intervals of all else, too.
const DECIDES: f64 = 20.0;

impl Rival {
    /// Whether the record leaves open which of both it is.
    pub fn is_undecided(&self) -> bool {
        !is_decided(self.log_odds)
    }
}

/// Whether odds of which this is the logarithm decide for a name.
pub fn is_decided(log_odds: f64) -> bool {
    log_odds >= DECIDES.ln()
}
