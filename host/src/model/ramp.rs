//! Rate ramp: a steady drift, the one term that is not random.

use super::random::Generator;
use super::{Seed, Term};

/// What it is, in a sentence.
pub const MEANING: &str = "steady drift of the zero, not random: warming up or cooling down";

/// Ramp from zero. Pavlov and Petrov eq. 8, first term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// R: slope, unit of the signal per second.
    pub per_s: f64,
}

impl Term for Ramp {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        // Exact: neighbouring means differ by R tau, sampled or not.
        self.allan_asymptote(m as f64 / rate_hz)
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        (self.per_s * tau_s).powi(2) / 2.0
    }

    fn spectrum(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn spectrum_ahead(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn is_drift(&self) -> bool {
        true
    }

    fn generator(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Generator> {
        Box::new(Line {
            slope: self.per_s / rate_hz,
            index: 0,
        })
    }
}

struct Line {
    slope: f64,
    index: u64,
}

impl Generator for Line {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            // From the index, not by adding up: no rounding error grows.
            *sample += self.slope * self.index as f64;
            self.index += 1;
        }
    }
}
