//! One tone of constant size whose frequency wanders: its density, with what folds back, and its Allan variance.

use std::f64::consts::PI;

use crate::model::kernel::{self, Kernel};
use crate::model::wander::Wander;

/// One line of a [`WanderingLine`](super::WanderingLine).
pub(super) struct Tone {
    /// Mean frequency, hertz.
    pub f_hz: f64,
    /// How it wanders.
    pub wander: Wander,
    /// Mean square, unit of the signal squared.
    pub power: f64,
}

impl Tone {
    /// Two-sided density in continuous time.
    pub fn density(&self, f_hz: f64) -> f64 {
        let shape = |offset_hz: f64| self.wander.shape(offset_hz);
        0.5 * self.power * (shape(f_hz - self.f_hz) + shape(f_hz + self.f_hz))
    }

    /// With what folds back onto it: the next image on either side, beyond which the shape has fallen as the fourth
    /// power of the distance.
    pub fn sampled(&self, f_hz: f64, rate_hz: f64) -> f64 {
        [-rate_hz, 0.0, rate_hz]
            .map(|shift_hz| self.density(f_hz + shift_hz))
            .iter()
            .sum()
    }

    /// Allan variance of the samples: the integral of the density over the kernel, on panels that are as narrow as
    /// the line at its frequency and as the kernel's oscillation near zero.
    pub fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        /// Oscillations of the kernel from zero on that are always resolved; beyond, those that are far narrower
        /// than the density's own changes are averaged over.
        const CYCLES: f64 = 32.0;
        let cycle_hz = rate_hz / m as f64;
        let core_hz = self.wander.half_width_hz();
        let smooth_hz = |f_hz: f64| {
            let off_hz = (f_hz - self.f_hz).abs();
            (0.2 * off_hz).max(0.25 * core_hz)
        };
        let width_hz = |f_hz: f64| {
            let finest_hz = if f_hz < CYCLES * cycle_hz {
                0.25 * cycle_hz
            } else {
                (0.25 * cycle_hz).max(0.125 * smooth_hz(f_hz))
            };
            smooth_hz(f_hz).min(finest_hz)
        };
        let kernel = |f_hz: f64| {
            let x = PI * f_hz / rate_hz;
            if f_hz < CYCLES * cycle_hz || 0.25 * cycle_hz >= 0.125 * smooth_hz(f_hz) {
                Kernel::Allan.at(m, x)
            } else {
                Kernel::Allan.mean(m, x)
            }
        };
        let nodes = kernel::nodes(0.0, 0.5 * rate_hz, width_hz);
        let sum: f64 = nodes
            .map(|(f_hz, weight)| weight * self.sampled(f_hz, rate_hz) * kernel(f_hz))
            .sum();
        2.0 * sum
    }
}
