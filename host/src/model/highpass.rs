//! High-pass: what is slower than a corner does not come through.

use std::f64::consts::PI;

use super::Seed;
use super::effect::{Band, Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::filter::{self, DEEPEST, HighPass};
use super::kind::Kind;
use super::marks::Mark;

/// Poles of a Butterworth high-pass on all that is there.
///
/// `|H|^2 = x^(2 poles) / (1 + x^(2 poles))`, `x = tan(pi f / rate) / tan(pi corner / rate)`: by the bilinear transform, which
/// is the analog filter far below the rate, where corners are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// Frequency of half power, hertz.
    pub corner_hz: f64,
    /// How many poles, one or more.
    pub poles: u8,
}

/// Poles at most: a choice. A coupling has one, a geophone two, a filter for hum in ears four.
const MOST_POLES: f64 = 12.0;

/// Up to which share of the rate a frequency is bent: a choice that keeps numbers finite.
const HIGHEST: f64 = 0.4999;

impl Coupling {
    /// With these parameters, in the catalogue's order; of one pole where no more is said.
    pub fn of(values: &[f64]) -> Self {
        let poles = values.get(1).copied().unwrap_or(1.0);
        Self {
            corner_hz: values[0],
            poles: poles.clamp(1.0, MOST_POLES) as u8,
        }
    }

    /// The tangent of half the radians a sample that a frequency is.
    fn bent(f_hz: f64, rate_hz: f64) -> f64 {
        (PI * f_hz.min(HIGHEST * rate_hz) / rate_hz).tan()
    }
}

impl Distortion for Coupling {
    fn stage(&self) -> Stage {
        Stage::Coupling
    }

    fn power(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let corners = Self::bent(f_hz, rate_hz) / Self::bent(self.corner_hz, rate_hz);
        let passed = corners.powi(2 * i32::from(self.poles));
        if passed.is_finite() {
            (passed / (1.0 + passed)).max(DEEPEST)
        } else {
            1.0
        }
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        Box::new(HighPass::new(
            self.poles,
            Self::bent(self.corner_hz, rate_hz),
        ))
    }
}

/// High-pass in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "highpass"
    }

    fn meaning(&self) -> &'static str {
        "the spectrum falls toward zero: AC coupling, a geophone's own resonance, or a running mean that a driver or a script \
         took away"
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "look for a coupling capacitor, an option `AC` or `HPF` of sensor and amplifier, or a mean taken away in the \
             driver, of {:.4} Hz: what is slower is not in this record, and its drift cannot be told from it",
            values[0]
        )
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let corner = Parameter::new("corner_hz", Quantity::Hertz, "frequency of half power");
        let poles = Parameter::new(
            "poles",
            Quantity::Count,
            "poles of a Butterworth response; left out, one",
        );
        let all = [corner, poles];
        all.into_iter().take(values.len().max(1)).collect()
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        vec![Mark::Corner(values[0])]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Coupling::of(values)))
    }

    fn surprise_nats(&self, values: &[f64], _rate_hz: f64) -> f64 {
        /// What a coupling costs: one record in a thousand has one, a choice. A walk behind one pole is noise with a correlation
        /// time, of which nothing but the white noise far below all that tells it.
        const NATS: f64 = 7.0;
        NATS + filter::surprise_nats(values)
    }

    fn starts(&self, band: &Band) -> Vec<Vec<f64>> {
        /// From where a few bins lie below the corner,
        const ABOVE_LOWEST: f64 = 4.0;
        /// up to a tenth of half the rate: what is faster is no coupling, but a difference of samples.
        const BELOW_HIGHEST: f64 = 0.1;
        let corners = Band {
            from_hz: ABOVE_LOWEST * band.from_hz,
            to_hz: BELOW_HIGHEST * band.to_hz,
        };
        let corners: Vec<f64> = corners.steps(2.0).collect();
        filter::starts(&corners, &[&[], &[2.0]])
    }
}

#[cfg(test)]
mod tests {
    use crate::model::trial;

    #[test]
    fn what_is_simulated_follows_the_law() {
        for poles in ["", r#", "poles": 2"#] {
            let effect =
                format!(r#"{{ "effect": "highpass", "parameters": {{ "corner_hz": 3{poles} }} }}"#);
            let axis = trial::axis(r#""N": 0.02, "K": 0.1"#, &effect);
            trial::assert_allan_variance(&axis, 1000.0, &[1, 8, 100, 400]);
        }
    }
}
