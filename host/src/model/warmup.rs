//! Warm-up: the level settles exponentially from the start of the record.

use super::Seed;
use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::once::Once;
use super::random::Generator;

/// The course `amplitude exp(-t / time_s)`. Not random: as for [`Steps`](super::steps::Steps),
/// the law says zero, and whoever knows the record takes out the course that the generator makes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WarmUp {
    /// Distance from the final level at the start, unit of the signal.
    pub amplitude: f64,
    /// Time in which it falls to 1/e, seconds.
    pub time_s: f64,
}

impl Once for WarmUp {
    fn drifts(&self) -> bool {
        true
    }

    fn course(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Generator> {
        Box::new(Settling::new(self.amplitude, self.time_s * rate_hz))
    }
}

/// The course of a settling, sample by sample from the first.
pub struct Settling {
    amplitude: f64,
    /// Data period over the time constant.
    decay: f64,
    index: u64,
}

impl Settling {
    /// From `amplitude` down, with a time constant of so many samples.
    pub fn new(amplitude: f64, samples: f64) -> Self {
        Self {
            amplitude,
            decay: samples.recip(),
            index: 0,
        }
    }
}

impl Generator for Settling {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            // From the index, not by repeated products: no rounding error grows.
            *sample += self.amplitude * (-self.decay * self.index as f64).exp();
            self.index += 1;
        }
    }
}

/// Warm-up in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "warmup"
    }

    fn meaning(&self) -> &'static str {
        "the level settles exponentially from the start: sensor, reference or board warming up \
         after power came on"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new(
                "amplitude",
                Quantity::Signal,
                "distance from the final level at the start",
            ),
            Parameter::new("time_s", Quantity::Second, "time in which it falls to 1/e"),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "switch on {:.0} s before the record, five of its time constants: if it is gone, leave \
             that much time; if not, it is no warming up",
            5.0 * values[1]
        )
    }

    fn size(&self) -> Option<usize> {
        Some(0)
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        /// Time constants after which a settling is over for the eye.
        const SETTLED: f64 = 5.0;
        vec![Mark::Stretch(0.0, SETTLED * values[1])]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(WarmUp {
            amplitude: values[0],
            time_s: values[1],
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_in_its_half_life() {
        let warm_up = WarmUp {
            amplitude: -4.0,
            time_s: 0.5 / std::f64::consts::LN_2,
        };
        let mut samples = vec![1.0; 2001];
        let seed = Seed { seed: 1, stream: 0 };
        warm_up.course(1000.0, seed).add_to(&mut samples);
        for (index, expected) in [(0, -3.0), (500, -1.0), (1000, 0.0), (2000, 0.75)] {
            assert!((samples[index] - expected).abs() < 1e-12, "{index}");
        }
    }
}
