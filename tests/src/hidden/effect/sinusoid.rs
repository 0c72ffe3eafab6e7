//! A line anywhere but at the mains' frequencies.

use std::f64::consts::TAU;

use super::tone::{Tone, frequency, trials};
use super::{Effect, Evidence, Gain, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::power;

struct Sinusoid(Tone);

pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    Box::new(Sinusoid(Tone {
        f_hz: frequency(scene, draw),
        amplitude: 1e-3,
        phase: draw.uniform(0.0, TAU),
    }))
}

impl Effect for Sinusoid {
    fn truths(&self) -> Vec<Truth> {
        let Tone {
            f_hz, amplitude, ..
        } = self.0;
        vec![Truth::new(
            "sinusoid",
            &[("f_hz", f_hz), ("amplitude", amplitude)],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self(self.0.scaled(factor)))
    }

    fn evidence(&self, scene: &Scene) -> Evidence {
        Evidence::power(power(self.0.energy(scene), 2.0, trials(scene.samples)))
    }

    fn tones(&self, scene: &Scene, _draw: &mut Draw, gain: Gain<'_>) -> Option<Vec<f64>> {
        let mut samples = vec![0.0; scene.samples];
        let behind = self.0.scaled(gain(self.0.f_hz));
        behind.add_to(&mut samples, scene.rate_hz);
        Some(samples)
    }
}
