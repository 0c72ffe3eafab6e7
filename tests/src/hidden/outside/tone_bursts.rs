//! A tone that comes and goes, each time with another phase and a slightly other frequency.

use std::f64::consts::TAU;

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Effect;
use crate::hidden::ideal::detector::{Evidence, power};
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct ToneBursts {
    f_hz: f64,
    spread_hz: f64,
    on_s: f64,
    amplitude: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let f_hz = draw.log_uniform(65.0, 500.0);
    Box::new(ToneBursts {
        f_hz,
        spread_hz: 0.02 * f_hz,
        on_s: draw.log_uniform(2.0, 15.0),
        amplitude: 1e-3,
    })
}

impl Effect for ToneBursts {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "tone_bursts",
            &[
                ("f_hz", self.f_hz),
                ("on_s", self.on_s),
                ("amplitude", self.amplitude),
            ],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            amplitude: self.amplitude * factor,
            ..*self
        })
    }

    /// One burst of average length by itself, searched over all frequencies and times.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let passed = scene.chain.power(self.f_hz, scene.rate_hz);
        let noise = scene.density(scene.target, self.f_hz);
        let energy = self.amplitude.powi(2) * self.on_s * passed / (2.0 * noise);
        Evidence::power(power(energy, 2.0, 4.0 * scene.samples as f64))
    }

    fn waveform(&self, scene: &Scene, _axis: usize, draw: &mut Draw) -> Option<Vec<f64>> {
        let mut samples = vec![0.0; scene.samples];
        let mut from_s = draw.exponential(3.0 * self.on_s);
        while from_s < scene.duration_s() {
            let to_s = from_s + self.on_s * draw.uniform(0.5, 1.5);
            let f_hz = self.f_hz + self.spread_hz * draw.uniform(-1.0, 1.0);
            let phase = draw.uniform(0.0, TAU);
            let from = (from_s * scene.rate_hz) as usize;
            let to = ((to_s * scene.rate_hz) as usize).min(scene.samples);
            for (i, sample) in samples[from..to].iter_mut().enumerate() {
                *sample = self.amplitude * (TAU * f_hz * i as f64 / scene.rate_hz + phase).cos();
            }
            from_s = to_s + draw.exponential(3.0 * self.on_s);
        }
        Some(samples)
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Band(
            self.f_hz - self.spread_hz,
            self.f_hz + self.spread_hz,
        ))
    }
}
