//! Rate random walk: the signal itself is the sum of independent steps.

use super::random::{Gaussian, Generator};
use super::{Seed, Term};

/// What it is, in a sentence.
pub const MEANING: &str = "slow wandering of the zero, without return: ageing, temperature \
                           gradients, stress of the package";

/// Random walk, starting from zero. Pavlov and Petrov eq. 8, second term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walk {
    /// K: growth, unit of the signal per root second.
    pub per_root_s: f64,
}

impl Term for Walk {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        let m = m as f64;
        self.allan_asymptote(m / rate_hz) * (1.0 + 0.5 / (m * m))
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        self.per_root_s.powi(2) * tau_s / 3.0
    }

    fn spectrum(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let sine = (std::f64::consts::PI * f_hz / rate_hz).sin();
        (self.per_root_s / (2.0 * rate_hz * sine)).powi(2)
    }

    fn spectrum_ahead(&self, f_hz: f64, _rate_hz: f64) -> f64 {
        (self.per_root_s / (std::f64::consts::TAU * f_hz)).powi(2)
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let noise = Gaussian::new(seed, self.per_root_s / rate_hz.sqrt());
        Box::new(Summed { noise, level: 0.0 })
    }
}

struct Summed {
    noise: Gaussian,
    level: f64,
}

impl Generator for Summed {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            *sample += self.level;
            self.level += self.noise.draw();
        }
    }
}
