//! What is slow enough to be judged on a record that is thinned to its slow part.

use super::Scene;
use crate::hidden::ideal::matched::Whitened;
use crate::hidden::noise::chain::Chain;

/// Factor by which the rate is lowered.
const THIN: usize = 1024;

/// Samples that are left of a short record.
const LEAST: usize = 64;

/// Steps of a row, evenly over the record, of which the best is fitted.
const STEPS: usize = 20;

/// Share of a waveform's energy that is left where the best of a row of steps is fitted as well as a ramp; `waveform` makes
/// it for a scene.
pub fn share_beside_step(scene: &Scene, waveform: impl Fn(&Scene) -> Vec<f64>) -> f64 {
    // The record thinned to its slow part is enough here: the waveform has no fast one.
    let thin = THIN.min(scene.samples / LEAST);
    let mut thinned = Scene {
        samples: scene.samples / thin,
        rate_hz: scene.rate_hz / thin as f64,
        chain: Chain::None,
        missing: 0.0,
        code: 0.0,
        ..scene.clone()
    };
    let base = &mut thinned.axes[scene.target];
    // Means miss nothing; what their samples miss is white.
    base.n = (base.n.powi(2) + scene.lost_density(scene.target)).sqrt();
    base.q = 0.0;
    let slow = |values: Vec<f64>| Whitened::new(&values, &thinned, scene.target);
    let ramp = || slow((0..thinned.samples).map(|i| i as f64).collect());
    let own = || slow(waveform(&thinned)).without(&ramp());
    let beside = (1..STEPS).map(|i| {
        let at = i * thinned.samples / STEPS;
        let step = (0..thinned.samples).map(|j| f64::from(u8::from(j >= at)));
        let step = slow(step.collect()).without(&ramp());
        own().without(&step).energy()
    });
    beside.fold(f64::INFINITY, f64::min) / own().energy()
}
