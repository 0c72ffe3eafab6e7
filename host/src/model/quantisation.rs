//! Quantisation noise: white noise of the integral, so differenced white noise of the signal.

use super::random::{Gaussian, Generator};
use super::{Seed, Term};

/// What it is, in a sentence.
pub const MEANING: &str = "error of the integrated signal that does not grow with time: rounding \
                           of the velocity, or jitter of the sampling";

/// Quantisation noise. Pavlov and Petrov eq. 8, last term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantisation {
    /// Q: standard deviation of the integral, unit of the signal times seconds.
    pub step: f64,
}

impl Term for Quantisation {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        // Exact for the sampled process: second differences of a white sequence.
        self.allan_asymptote(m as f64 / rate_hz)
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        3.0 * (self.step / tau_s).powi(2)
    }

    fn spectrum(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let sine = (std::f64::consts::PI * f_hz / rate_hz).sin();
        self.step.powi(2) * 4.0 * sine * sine * rate_hz
    }

    fn spectrum_ahead(&self, f_hz: f64, rate_hz: f64) -> f64 {
        (self.step * std::f64::consts::TAU * f_hz).powi(2) / rate_hz
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let mut noise = Gaussian::new(seed, self.step * rate_hz);
        let last = noise.draw();
        Box::new(Differenced { noise, last })
    }
}

struct Differenced {
    noise: Gaussian,
    last: f64,
}

impl Generator for Differenced {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            let next = self.noise.draw();
            *sample += next - self.last;
            self.last = next;
        }
    }
}
