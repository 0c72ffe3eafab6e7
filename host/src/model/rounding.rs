//! Coarse steps: the effect `quantisation`. Its namesake among the five terms, which is the
//! differenced noise of a rounded integral, is in [`quantisation`](super::quantisation).

use super::Seed;
use super::effect::{Distorter, Distortion, Effect, Incoming, Parameter, Part, Quantity, Stage};
use super::kind::Kind;
use crate::numeric::written::significant;

/// Samples are rounded to multiples of a step, counted from zero and not from the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    /// The step, unit of the signal; without a sign, and none for zero.
    pub step: f64,
}

impl Rounding {
    /// With these parameters, in the catalogue's order.
    pub fn of(values: &[f64]) -> Self {
        Self { step: values[0] }
    }

    /// The rounding whose error has this [density](Self::density) at a data rate of `rate_hz`.
    pub fn of_density(density: f64, rate_hz: f64) -> Self {
        Self {
            step: (12.0 * density * rate_hz).sqrt(),
        }
    }

    /// Two-sided density of the rounding's error at a data rate of `rate_hz`: white noise of the variance
    /// `step^2 / 12`, uncorrelated with what is rounded. W. R. Bennett, Bell Syst. Tech. J. 27 (1948) 446. It
    /// needs a change of half a step or more (one standard deviation) from one sample to the next; below
    /// that the error comes to depend on the level, and no stationary law describes it.
    pub fn density(&self, rate_hz: f64) -> f64 {
        self.step.powi(2) / 12.0 / rate_hz
    }
}

impl Distortion for Rounding {
    fn stage(&self) -> Stage {
        Stage::Number
    }

    fn adds(&self, incoming: &Incoming<'_>) -> Vec<f64> {
        vec![self.density(incoming.rate_hz) * incoming.rate_hz]
    }

    fn distorter(&self, _rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        Box::new(*self)
    }
}

impl Distorter for Rounding {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        if self.step == 0.0 {
            return;
        }
        for sample in samples {
            *sample = (*sample / self.step).round() * self.step;
        }
    }
}

/// Coarse steps in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "quantisation"
    }

    fn meaning(&self) -> &'static str {
        "few distinct values: bits were cut off on the way, or the gain ahead of the converter is \
         too small"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new(
            "step",
            Quantity::Signal,
            "distance of neighbouring values",
        )]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "compare the step of {} with one code of the converter: as much is its resolution, \
             a power of two times as much is bits lost in a conversion or a file format",
            significant(values[0].abs(), 7)
        )
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Rounding::of(values)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::trial;

    #[test]
    fn values_are_multiples_of_the_step() {
        let mut samples = vec![9.8, -0.3, 0.3, 0.24, 0.0];
        let seed = Seed { seed: 1, stream: 0 };
        Rounding { step: 0.5 }
            .distorter(1.0, seed)
            .apply(&mut samples);
        assert_eq!(samples, [10.0, -0.5, 0.5, 0.0, 0.0]);
    }

    #[test]
    fn allan_variance_follows_the_law() {
        // Noise of one step: a twelfth of its power is added.
        let rounding = r#"{ "effect": "quantisation", "parameters": { "step": 1 } }"#;
        let axis = trial::axis(r#""N": 0.0316227766016838"#, rounding);
        trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 7, 30]);
    }
}
