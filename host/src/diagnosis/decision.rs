//! What a search decides on its way, for those who want to follow it.

use std::fmt;

use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::loser::Loser;
use crate::model::effect::Parameter;
use crate::model::kind::Kind;
use crate::numeric::written::plain;

/// One decision of a search.
#[derive(Debug, Clone, PartialEq)]
pub enum Decision {
    /// A candidate was taken in as an explanation. What only amends a known one is not said.
    Taken {
        /// Its kind.
        kind: Kind,
        /// Its first parameter that is known then: a frequency, a moment, a corner.
        first: Option<(Parameter, f64)>,
        /// Its p-value.
        p_value: f64,
    },
    /// A candidate was declined.
    Declined {
        /// Its kind.
        kind: Kind,
        /// Its p-value.
        p_value: f64,
        /// Why.
        why: Declined,
    },
    /// Explanations of these kinds were taken back.
    Withdrawn {
        /// The kinds.
        kinds: Vec<Kind>,
        /// What speaks against them.
        why: &'static str,
    },
    /// A band was excluded from the fits.
    Excluded {
        /// Its lower end, hertz.
        from_hz: f64,
        /// Its upper end, hertz.
        to_hz: f64,
    },
    /// The axis is searched from its beginning, without these.
    Anew(Vec<Loser>),
}

/// Why a candidate is declined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Declined {
    /// It gained too little on held-out data before, or left nothing that could be fitted.
    Lost,
    /// The record has no room for its parameters.
    NoRoom,
}

impl Decision {
    /// That a candidate was taken in.
    pub fn taken(candidate: &Candidate) -> Self {
        let kind = candidate.effect.kind;
        // The size of a law is told by the fit, once it is in.
        let (values, place) = match &candidate.change {
            Change::Law(law) => (law.values.clone(), law.shape().next()),
            _ => (candidate.effect.plain(), Some(0)),
        };
        let parameters = kind.parameters(&values).into_iter();
        let mut known = parameters.zip(values);
        Self::Taken {
            kind,
            first: place.and_then(|place| known.nth(place)),
            p_value: candidate.p_value,
        }
    }

    /// That what there was `before` and is not among the `left` was taken back, and why; `None` where all is left.
    pub fn withdrawn(before: &[Kind], left: &[Explanation], why: &'static str) -> Option<Self> {
        let mut gone = before.to_vec();
        for one in left {
            if let Some(number) = gone.iter().position(|kind| *kind == one.kind()) {
                gone.remove(number);
            }
        }
        (!gone.is_empty()).then_some(Self::Withdrawn { kinds: gone, why })
    }
}

impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Taken {
                kind,
                first,
                p_value,
            } => {
                write!(f, "taken in: {kind}")?;
                if let Some((parameter, value)) = first {
                    write!(f, ", {} {}", parameter.name, plain(*value))?;
                }
                write!(f, ", by chance {p_value:.1e}")
            }
            Self::Declined { kind, p_value, why } => {
                let why = match why {
                    Declined::Lost => {
                        "gained too little on held-out data before, or left nothing to fit"
                    }
                    Declined::NoRoom => "larger than the record",
                };
                write!(f, "declined: {kind}, by chance {p_value:.1e}: {why}")
            }
            Self::Withdrawn { kinds, why } => write!(f, "taken back: {}: {why}", joined(kinds)),
            Self::Excluded { from_hz, to_hz } => {
                let (from, to) = (plain(*from_hz), plain(*to_hz));
                write!(f, "left out of the fits: {from} to {to} Hz")
            }
            Self::Anew(losers) => write!(f, "searched anew without: {}", joined(losers)),
        }
    }
}

fn joined<T: fmt::Display>(all: &[T]) -> String {
    let all: Vec<String> = all.iter().map(ToString::to_string).collect();
    all.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::{NOTHING, axis, short, take_in};
    use crate::model::{burst, steps};

    #[test]
    fn what_is_gone_was_taken_back() {
        let mut axis = axis(1, short(1), |_, noise| noise);
        for kind in [steps::KIND, burst::KIND, steps::KIND] {
            take_in(&mut axis, kind, NOTHING);
        }
        let all = axis.kinds();
        assert_eq!(Decision::withdrawn(&all, axis.explanations(), "gone"), None);
        axis.withdraw_where(|one| one.kind() == burst::KIND);
        let gone = Decision::withdrawn(&all, axis.explanations(), "it went").expect("one is gone");
        assert_eq!(gone.to_string(), "taken back: burst: it went");
        let both = Decision::withdrawn(&all, &axis.explanations()[..1], "gone");
        assert_eq!(
            both,
            Some(Decision::Withdrawn {
                kinds: vec![burst::KIND, steps::KIND],
                why: "gone",
            })
        );
    }
}
