//! High-pass: what is slower than a corner does not come through.

use std::f64::consts::PI;

use super::Seed;
use super::effect::{Band, Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::filter::{self, DEEPEST, HighPass, LessMean};
use super::kind::Kind;
use super::marks::Mark;

/// What keeps the slow out of all that is noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// Frequency of half power, or one over the time that a mean is over, hertz.
    pub corner_hz: f64,
    /// What does it.
    pub sort: Sort,
}

/// Sorts of what keeps the slow out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    /// So many poles of a Butterworth response: `|H|^2 = x^(2 poles) / (1 + x^(2 poles))`, `x = tan(pi f / rate) /
    /// tan(pi corner / rate)`, by the bilinear transform, which is the analog filter far below the rate, where corners are.
    Poles(u8),
    /// The mean of what came up to each sample is taken away: `|H|^2 = 1 - 2 s cos p + s^2`, `p = pi f / corner`, `s = sin p / p`.
    MeanBefore,
    /// The mean about each sample is: `|H|^2 = (1 - s)^2`.
    MeanAbout,
}

/// Poles at most: a choice. A coupling has one, a geophone two, a filter for hum in ears four.
const MOST_POLES: f64 = 12.0;

/// Least power that a record shows: what goes through is cut off at either end, and in means over blocks some of it passes for
/// slow. A choice, far below what any drift is that matters.
const DEEPEST_SHOWN: f64 = 1e-3;

/// Up to which share of the rate a frequency is bent: a choice that keeps numbers finite.
const HIGHEST: f64 = 0.4999;

impl Coupling {
    /// With these parameters, in the catalogue's order; of one pole where no more is said.
    pub fn of(values: &[f64]) -> Self {
        let sort = match (values.get(1), values.get(2)) {
            (None, _) => Sort::Poles(1),
            (Some(poles), _) if *poles >= 1.0 => Sort::Poles(poles.min(MOST_POLES) as u8),
            (_, Some(centred)) if *centred > 0.0 => Sort::MeanAbout,
            _ => Sort::MeanBefore,
        };
        Self {
            corner_hz: values[0],
            sort,
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
        let phase = PI * f_hz / self.corner_hz;
        let mean = if phase == 0.0 {
            1.0
        } else {
            phase.sin() / phase
        };
        let power = match self.sort {
            Sort::Poles(poles) => {
                let corners = Self::bent(self.corner_hz, rate_hz) / Self::bent(f_hz, rate_hz);
                1.0 / (1.0 + corners.powi(2 * i32::from(poles)))
            }
            Sort::MeanBefore => 1.0 - 2.0 * mean * phase.cos() + mean * mean,
            Sort::MeanAbout => (1.0 - mean).powi(2),
        };
        power.max(DEEPEST)
    }

    fn shown(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.power(f_hz, rate_hz).max(DEEPEST_SHOWN)
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        let samples = (rate_hz / self.corner_hz).max(1.0);
        match self.sort {
            Sort::Poles(poles) => {
                Box::new(HighPass::new(poles, Self::bent(self.corner_hz, rate_hz)))
            }
            Sort::MeanBefore => Box::new(LessMean::new(samples, 0)),
            Sort::MeanAbout => Box::new(LessMean::new(samples, (0.5 * samples) as usize)),
        }
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
            "poles of a Butterworth response; left out, one; 0 where a running mean over 1 / corner_hz is taken away",
        );
        let centred = Parameter::new(
            "centred",
            Quantity::Count,
            "1 where that mean is about each sample, 0 or left out where it is up to it",
        );
        let all = [corner, poles, centred];
        all.into_iter().take(values.len().max(1)).collect()
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        vec![Mark::Corner(values[0])]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Coupling::of(values)))
    }

    fn surprise_nats(&self, values: &[f64], _rate_hz: f64) -> f64 {
        /// What a coupling costs: one record in 150 has one, a choice. A walk behind one pole is noise with a correlation
        /// time, of which nothing but the white noise far below all that tells it.
        const NATS: f64 = 5.0;
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
        filter::starts(&corners, &[&[], &[2.0], &[0.0], &[0.0, 1.0]])
    }
}

#[cfg(test)]
mod tests {
    use crate::model::trial;

    #[test]
    fn what_is_simulated_follows_the_law() {
        for sort in [
            "",
            r#", "poles": 2"#,
            r#", "poles": 0"#,
            r#", "poles": 0, "centred": 1"#,
        ] {
            let effect =
                format!(r#"{{ "effect": "highpass", "parameters": {{ "corner_hz": 3{sort} }} }}"#);
            let axis = trial::axis(r#""N": 0.02, "K": 0.1"#, &effect);
            trial::assert_allan_variance(&axis, 1000.0, &[1, 8, 100, 400]);
        }
    }
}
