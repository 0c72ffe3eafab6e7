//! White noise of the signal: velocity random walk for an accelerometer, angle random walk for
//! a gyroscope.

use super::random::{Gaussian, Generator};
use super::{Seed, Term};

/// What it is, in a sentence.
pub const MEANING: &str = "white noise of the signal: thermal noise of sensor and electronics; \
                           the integral wanders with the root of time";

/// White noise. Pavlov and Petrov eq. 2 and eq. 8, fourth term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct White {
    /// N: root of the two-sided spectral density, unit of the signal per root hertz.
    pub root_density: f64,
}

impl Term for White {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        // Exact for the sampled process as well.
        self.allan_asymptote(m as f64 / rate_hz)
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        self.root_density.powi(2) / tau_s
    }

    fn spectrum(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        self.root_density.powi(2)
    }

    fn spectrum_ahead(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        self.root_density.powi(2)
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        Box::new(Gaussian::new(seed, self.root_density * rate_hz.sqrt()))
    }
}
