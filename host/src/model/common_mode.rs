//! Common mode: axes share a disturbance.

use super::effect::{Effect, Parameter, Part, Quantity};
use super::follows::{Follows, Leader};
use super::kind::Kind;

/// An axis has part in what the axes share.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "common_mode"
    }

    fn meaning(&self) -> &'static str {
        "axes share a disturbance: ripple of the supply or the reference, or the block shaking"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new(
            "gain",
            Quantity::Ratio,
            "what is shared, relative to the first axis",
        )]
    }

    fn check(&self, values: &[f64]) -> String {
        let gain = match values[0].is_finite() {
            true => format!(" of {:.3}", values[0]),
            false => String::new(),
        };
        format!(
            "turn the block by a quarter: shaking changes its gain{gain} with the direction, supply and reference do \
             not; then feed the board from a battery"
        )
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Follows(Follows {
            leader: Leader::Shared,
            gain: values[0],
            lag_s: 0.0,
        })
    }
}
