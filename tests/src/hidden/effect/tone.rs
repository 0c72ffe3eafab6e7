//! One line: shared by the effects that are made of lines or seen by them.

use std::f64::consts::TAU;

use crate::hidden::draw::Draw;
use crate::hidden::noise::chain::one_pole;
use crate::hidden::scene::Scene;

/// `amplitude cos(2 pi f t + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// Frequency, hertz.
    pub f_hz: f64,
    /// Amplitude.
    pub amplitude: f64,
    /// Phase at the start of the record, radians.
    pub phase: f64,
}

impl Tone {
    /// Non-centrality of the whole line in the noise of the scene's target.
    pub fn energy(&self, scene: &Scene) -> f64 {
        let passed = scene.chain.power(self.f_hz, scene.rate_hz);
        let noise = scene.seen_density(scene.target, self.f_hz) * scene.rate_hz;
        self.amplitude.powi(2) * scene.samples as f64 * passed / (2.0 * noise)
    }

    /// An amplitude whose line has this non-centrality.
    pub fn amplitude_for(f_hz: f64, energy: f64, scene: &Scene) -> f64 {
        let one = Self {
            f_hz,
            amplitude: 1.0,
            phase: 0.0,
        };
        (energy / one.energy(scene)).sqrt()
    }

    /// The same line `factor` times as large.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            amplitude: self.amplitude * factor,
            ..self
        }
    }

    /// Adds the line to `samples`.
    pub fn add_to(&self, samples: &mut [f64], rate_hz: f64) {
        for (i, sample) in samples.iter_mut().enumerate() {
            let cycles = (self.f_hz * i as f64 / rate_hz).fract();
            *sample += self.amplitude * (TAU * cycles + self.phase).cos();
        }
    }
}

/// Trials of a search for a line over all frequencies of `samples` samples: exceedances of a
/// periodogram that is continuous in frequency, `(N / 2) sqrt(pi z / 3)` at `z` about 18.
pub fn trials(samples: usize) -> f64 {
    2.2 * samples as f64
}

/// A frequency for a line that is no mains line: log-uniform from 100 cycles a record to 0.4 of
/// the rate, more than 1 Hz from every multiple of 50 and 60 Hz.
pub fn frequency(scene: &Scene, draw: &mut Draw) -> f64 {
    loop {
        let f_hz = draw.log_uniform(100.0 / scene.duration_s(), 0.4 * scene.rate_hz);
        let clear = [50.0, 60.0].iter().all(|mains| {
            let nearest = (f_hz / mains).round().max(1.0) * mains;
            (f_hz - nearest).abs() > 1.0
        });
        // In the converter's transition band the amplitude is a matter of the chain.
        if clear && scene.chain.power(f_hz, scene.rate_hz) > 0.9 * one_pole(f_hz, 300.0) {
            return f_hz;
        }
    }
}
