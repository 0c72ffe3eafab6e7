//! A tone that glides from one frequency to another in the course of the record: something that runs up.

use std::f64::consts::TAU;

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Effect;
use crate::hidden::ideal::detector::{Evidence, power};
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct Chirp {
    from_hz: f64,
    to_hz: f64,
    amplitude: f64,
}

pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let low_hz = draw.log_uniform(0.03, 0.15) * scene.rate_hz;
    let high_hz = low_hz * draw.uniform(1.1, 2.5);
    let (from_hz, to_hz) = match draw.chance(0.5) {
        true => (low_hz, high_hz),
        false => (high_hz, low_hz),
    };
    Box::new(Chirp {
        from_hz,
        to_hz,
        amplitude: 1e-3,
    })
}

impl Effect for Chirp {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "chirp",
            &[
                ("from_hz", self.from_hz),
                ("to_hz", self.to_hz),
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

    /// All of it at the worse end, searched over both frequencies: each in steps of `1/T`, of which half the
    /// record has as many as samples.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let at = |f_hz: f64| {
            let passed = scene.chain.power(f_hz, scene.rate_hz);
            let noise = scene.density(scene.target, f_hz) * scene.rate_hz;
            self.amplitude.powi(2) * scene.samples as f64 * passed / (2.0 * noise)
        };
        let energy = at(self.from_hz).min(at(self.to_hz));
        Evidence::power(power(energy, 2.0, (scene.samples as f64).powi(2)))
    }

    fn waveform(&self, scene: &Scene, _axis: usize, draw: &mut Draw) -> Option<Vec<f64>> {
        let start = draw.uniform(0.0, TAU);
        let glide = (self.to_hz - self.from_hz) / scene.duration_s();
        let sample = |i: usize| {
            let t_s = i as f64 / scene.rate_hz;
            let cycles = self.from_hz * t_s + 0.5 * glide * t_s * t_s;
            self.amplitude * (TAU * cycles.fract() + start).cos()
        };
        Some((0..scene.samples).map(sample).collect())
    }

    fn place(&self) -> Option<Place> {
        let (low_hz, high_hz) = (self.from_hz.min(self.to_hz), self.from_hz.max(self.to_hz));
        Some(Place::Band(low_hz, high_hz))
    }
}
