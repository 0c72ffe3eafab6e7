//! Exponential settling from the start of the record.

use super::slow::share_beside_step;
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::{Contrast, power};
use crate::hidden::ideal::matched::energy;

struct Warmup {
    amplitude: f64,
    time_s: f64,
    /// Non-centrality with mean and ramp fitted, and what is left of it where the best of a row
    /// of steps is fitted as well.
    energy: f64,
    beside_step: f64,
}

/// Time constants from a fiftieth to a fifth of the record: longer ones are a ramp.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let duration_s = scene.duration_s();
    let time_s = draw.log_uniform(duration_s / 50.0, duration_s / 5.0);
    let amplitude = 1e-3 * draw.sign();
    let waveform = settling(amplitude, time_s, scene);
    let energy = energy(&waveform, scene, scene.target);
    let share = share_beside_step(scene, |thinned| settling(amplitude, time_s, thinned));
    Box::new(Warmup {
        amplitude,
        time_s,
        energy,
        beside_step: energy * share,
    })
}

fn settling(amplitude: f64, time_s: f64, scene: &Scene) -> Vec<f64> {
    (0..scene.samples)
        .map(|i| amplitude * (-(i as f64) / (scene.rate_hz * time_s)).exp())
        .collect()
}

impl Effect for Warmup {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "warmup",
            &[("amplitude", self.amplitude), ("time_s", self.time_s)],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            amplitude: self.amplitude * factor,
            energy: self.energy * factor * factor,
            beside_step: self.beside_step * factor * factor,
            ..*self
        })
    }

    /// Trials: about five independent time constants. The rival is one step anywhere.
    fn evidence(&self, _scene: &Scene) -> Evidence {
        Evidence {
            power: power(self.energy, 2.0, 5.0),
            rival_error: Contrast::shift(self.beside_step).error(),
        }
    }

    fn waveform(&self, scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        Some(settling(self.amplitude, self.time_s, scene))
    }
}
