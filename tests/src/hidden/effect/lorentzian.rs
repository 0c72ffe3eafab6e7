//! The spectrum of an exponentially decaying correlation, about zero or about a frequency.

use std::f64::consts::{PI, TAU};

use crate::hidden::ideal::grid::Grid;
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

/// Correlation times of noise that is one pole's rival, in those of the pole.
const TIMES: [f64; 9] = [0.1, 0.3, 0.6, 0.8, 1.0, 1.2, 1.6, 3.0, 10.0];

/// What may stand in the place of one pole with this corner: the parts of `base`, and Markov noise of such a time.
pub fn in_place_of_a_pole(
    corner_hz: f64,
    base: &[Vec<f64>],
    grid: &Grid,
    scene: &Scene,
) -> impl Iterator<Item = Vec<Vec<f64>>> {
    TIMES.iter().map(move |time| {
        let width_hz = width_of(time / (TAU * corner_hz));
        let markov = grid.at(|f_hz| {
            let passed = scene.chain.power(f_hz, scene.rate_hz);
            lorentzian(f_hz, 0.0, width_hz, scene) * passed
        });
        base.iter().cloned().chain([markov]).collect()
    })
}
