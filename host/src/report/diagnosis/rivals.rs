//! What else a finding may be, in words.

use crate::diagnosis::result::rival::Rival;
use crate::numeric::written::significant;

/// What else explains the same, and how likely it is beside what is named.
pub fn rival(one: &Rival) -> String {
    let odds = significant(one.log_odds.abs(), 2);
    format!("or {}: e^{odds} times {} likely", one.effect, way(one))
}

/// Which way the odds of a rival are.
pub const fn way(one: &Rival) -> &'static str {
    if one.log_odds < 0.0 { "more" } else { "less" }
}
