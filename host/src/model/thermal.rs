//! Thermal: the signal follows the temperature.

use super::effect::{Effect, Parameter, Part, Quantity};
use super::follows::Follows;
use super::kind::Kind;
use crate::numeric::written::significant;

/// The signal follows the temperature column, behind a lag.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "thermal"
    }

    fn meaning(&self) -> &'static str {
        "the signal follows the temperature: zero drift of the sensor or the reference, behind \
         the heat capacity between them and the thermometer"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("gain", Quantity::SignalPerKelvin, "signal per kelvin"),
            Parameter::new(
                "lag_s",
                Quantity::Delay,
                "time constant by which the signal is behind",
            ),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "compare {} a kelvin with the data sheet's zero drift, then change the temperature \
             by 10 K and wait {:.0} s: the level follows, or it is chance",
            significant(values[0], 4),
            (5.0 * values[1]).max(1.0)
        )
    }

    fn size(&self) -> Option<usize> {
        Some(0)
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Follows(Follows::of_temperature(values))
    }
}
