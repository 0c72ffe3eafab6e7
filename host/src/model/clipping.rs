//! Clipping: nothing gets past a level.

use super::Seed;
use super::effect::{Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::kind::Kind;
use crate::numeric::written::significant;

/// What is beyond a level is held at it. How much that takes from the noise depends on how far
/// the mean is from the level, which wanders; the law leaves it at 1, which is right as long as
/// few samples are clipped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clipping {
    /// The level, unit of the signal, mean included.
    pub level: f64,
    /// +1 if nothing gets above the level, -1 if nothing gets below.
    pub side: f64,
}

impl Distortion for Clipping {
    fn stage(&self) -> Stage {
        Stage::Range
    }

    fn distorter(&self, _rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        Box::new(*self)
    }
}

impl Distorter for Clipping {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        for sample in samples {
            *sample = if self.side > 0.0 {
                sample.min(self.level)
            } else {
                sample.max(self.level)
            };
        }
    }
}

/// Clipping in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "clipping"
    }

    fn meaning(&self) -> &'static str {
        "samples pile up at an extreme: the converter's full scale, or an amplifier at its rail"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("level", Quantity::Signal, "where samples are held"),
            Parameter::new(
                "side",
                Quantity::Sign,
                "1 for from above, -1 for from below",
            ),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "compare {} with the converter's full scale, then with the amplifier's swing and \
             the sensor's range: reduce the gain or move the offset {}; where all others are far from it, a driver wrote it for \
             readings that failed: leave these empty in the file",
            significant(values[0], 7),
            if values[1] > 0.0 { "down" } else { "up" }
        )
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Clipping {
            level: values[0],
            side: values[1],
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_one_side() {
        for (side, expected) in [(1.0, [-3.0, 1.0, 1.5]), (-1.0, [1.5, 1.5, 9.0])] {
            let mut samples = vec![-3.0, 1.0, 9.0];
            let seed = Seed { seed: 1, stream: 0 };
            let clipping = Clipping { level: 1.5, side };
            clipping.distorter(1.0, seed).apply(&mut samples);
            assert_eq!(samples, expected, "side {side}");
        }
    }
}
