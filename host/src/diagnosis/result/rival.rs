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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::result::estimate::Estimate;
    use crate::diagnosis::result::finding::Finding;
    use crate::diagnosis::result::value::Value;
    use crate::model::{averaging, markov, rolloff};

    #[test]
    fn a_finding_has_the_names_that_the_record_does_not_decide_between() {
        // Odds of e^2.9 are 18, of e^3.1 they are 22.
        let estimate = Estimate::new(rolloff::KIND, [Value::exact(20.0)]);
        let mut finding = Finding::new(&estimate, 1e-9);
        assert_eq!(finding.name(), "rolloff");
        let rival = |effect, log_odds| Rival { effect, log_odds };
        finding.rivals = vec![rival(averaging::KIND, 2.9), rival(markov::KIND, 3.1)];
        assert_eq!(finding.name(), "rolloff or averaging");
        finding.rivals[1].log_odds = -0.5;
        assert_eq!(finding.name(), "rolloff or averaging or markov");
    }
}
