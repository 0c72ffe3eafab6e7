//! The spectrum of an exponentially decaying correlation, about zero or about a frequency.

use std::f64::consts::{PI, TAU};

use crate::hidden::scene::Scene;

/// Two-sided density per hertz of unit-variance noise with autocorrelation
/// `exp(-pi width |t|) cos(2 pi f0 t)`: of its samples where there is no chain (closed form of
/// all aliases), else of the process in continuous time.
pub fn lorentzian(f_hz: f64, f0_hz: f64, width_hz: f64, scene: &Scene) -> f64 {
    let one = |offset_hz: f64| {
        if scene.chain.is_none() {
            let decay = (-PI * width_hz / scene.rate_hz).exp();
            let cosine = (TAU * offset_hz / scene.rate_hz).cos();
            (1.0 - decay * decay) / (1.0 - 2.0 * decay * cosine + decay * decay) / scene.rate_hz
        } else {
            width_hz / TAU / (offset_hz * offset_hz + 0.25 * width_hz * width_hz)
        }
    };
    0.5 * (one(f_hz - f0_hz) + one(f_hz + f0_hz))
}

/// Full width of the spectrum of `exp(-|t| / time)`.
pub fn width_of(time_s: f64) -> f64 {
    1.0 / (PI * time_s)
}
