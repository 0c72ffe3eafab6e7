//! Shocks at random moments, each of which rings and dies away.

use std::f64::consts::TAU;

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Effect;
use crate::hidden::ideal::detector::{Evidence, power};
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct Ringing {
    f_hz: f64,
    decay_s: f64,
    every_s: f64,
    amplitude: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let f_hz = draw.log_uniform(65.0, 400.0);
    Box::new(Ringing {
        f_hz,
        decay_s: draw.uniform(5.0, 30.0) / f_hz,
        every_s: draw.log_uniform(5.0, 40.0),
        amplitude: 1e-2,
    })
}

impl Effect for Ringing {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "ringing",
            &[
                ("f_hz", self.f_hz),
                ("decay_s", self.decay_s),
                ("every_s", self.every_s),
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

    /// One shock by itself, `A^2 decay / (4 S)`, searched over all times and some tens of shapes.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let passed = scene.chain.power(self.f_hz, scene.rate_hz);
        let noise = scene.density(scene.target, self.f_hz);
        let energy = self.amplitude.powi(2) * self.decay_s * passed / (4.0 * noise);
        Evidence::power(power(energy, 2.0, 30.0 * scene.samples as f64))
    }

    fn waveform(&self, scene: &Scene, _axis: usize, draw: &mut Draw) -> Option<Vec<f64>> {
        let mut samples = vec![0.0; scene.samples];
        let lasting = (20.0 * self.decay_s * scene.rate_hz) as usize;
        let mut at_s = draw.exponential(self.every_s);
        while at_s < scene.duration_s() {
            let phase = draw.uniform(0.0, TAU);
            let from = (at_s * scene.rate_hz) as usize;
            for (i, sample) in samples[from..].iter_mut().take(lasting).enumerate() {
                let t_s = i as f64 / scene.rate_hz;
                let ring = (TAU * self.f_hz * t_s + phase).cos();
                *sample += self.amplitude * (-t_s / self.decay_s).exp() * ring;
            }
            at_s += draw.exponential(self.every_s);
        }
        Some(samples)
    }

    /// Its short life also makes heavy tails and moments of larger variance: any of them is a
    /// right place, but the band is the plainest.
    fn place(&self) -> Option<Place> {
        let half = 3.0 / (TAU * self.decay_s);
        Some(Place::Band(self.f_hz - half, self.f_hz + half))
    }
}
