//! A level that follows the temperature, late; the temperature comes with the record.

use std::f64::consts::TAU;

use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::power;
use crate::hidden::ideal::matched::energy;

struct Thermal {
    gain: f64,
    lag_s: f64,
    temperature: Vec<f64>,
    /// Temperature behind a first-order lag.
    followed: Vec<f64>,
    energy: f64,
}

/// A room whose temperature sways by half a degree: four waves of a third to a twentieth of the
/// record. The thermometer resolves 0.01 degrees of its own noise. Lags from 1 to 20 s.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let waves: Vec<(f64, f64, f64)> = (0..4)
        .map(|_| {
            let cycles = draw.log_uniform(3.0, 20.0);
            let height = 0.3 * draw.normal() / cycles.sqrt() * 2.0;
            (
                cycles / scene.samples as f64,
                height,
                draw.uniform(0.0, TAU),
            )
        })
        .collect();
    let (from_s, to_s) = scene.times_s((1.0, 20.0), 4.0, 25.0);
    let lag_s = draw.log_uniform(from_s, to_s);
    let smoothing = 1.0 - (-1.0 / (lag_s * scene.rate_hz)).exp();
    let mut reading = Draw::new(draw.index(usize::MAX) as u64, "thermometer");
    let mut temperature = Vec::with_capacity(scene.samples);
    let mut followed = Vec::with_capacity(scene.samples);
    // Ten lags ahead of the record, so that it starts settled.
    let lead = (10.0 * lag_s * scene.rate_hz) as i64;
    let mut level = 0.0;
    for i in -lead..scene.samples as i64 {
        let air: f64 = waves
            .iter()
            .map(|(cycles, height, phase)| height * (TAU * cycles * i as f64 + phase).sin())
            .sum();
        level += smoothing * (air - level);
        if i >= 0 {
            temperature.push(25.0 + air + 0.01 * reading.normal());
            followed.push(level);
        }
    }
    let gain = 1e-3 * draw.sign();
    let energy = energy(&followed, scene, scene.target) * gain * gain;
    Box::new(Thermal {
        gain,
        lag_s,
        temperature,
        followed,
        energy,
    })
}

impl Effect for Thermal {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "thermal",
            &[("gain", self.gain), ("lag_s", self.lag_s)],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            gain: self.gain * factor,
            energy: self.energy * factor * factor,
            temperature: self.temperature.clone(),
            followed: self.followed.clone(),
            ..*self
        })
    }

    /// Mean and ramp fitted too. Trials: about five independent lags.
    fn evidence(&self, _scene: &Scene) -> Evidence {
        Evidence::power(power(self.energy, 2.0, 5.0))
    }

    fn waveform(&self, _scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        Some(self.followed.iter().map(|t| self.gain * t).collect())
    }

    fn temperature(&self) -> Option<&[f64]> {
        Some(&self.temperature)
    }
}
