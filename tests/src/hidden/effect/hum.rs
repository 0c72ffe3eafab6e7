//! Mains hum: a base frequency near 50 or 60 Hz and some of its harmonics.

use std::f64::consts::TAU;

use super::tone::Tone;
use super::{Effect, Evidence, Gain, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::{Contrast, power};

/// Lines at multiples of one base.
#[derive(Clone)]
pub struct Hum {
    base_hz: f64,
    /// Harmonic number and line.
    lines: Vec<(u32, Tone)>,
}

pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    Box::new(Hum::draw(scene, draw))
}

impl Hum {
    /// The base and one to three of the second to fifth harmonic, each 0.3 to 1 times as far
    /// above the noise as the base.
    pub fn draw(scene: &Scene, draw: &mut Draw) -> Self {
        let base_hz = draw.pick(&[50.0, 60.0]) + draw.uniform(-0.05, 0.05);
        let mut lines = vec![(1, 1.0)];
        let mut numbers = vec![2, 3, 4, 5];
        for _ in 0..=draw.index(3) {
            let number = numbers.remove(draw.index(numbers.len()));
            lines.push((number, draw.log_uniform(0.3, 1.0)));
        }
        lines.sort_by_key(|(number, _)| *number);
        let lines = lines
            .into_iter()
            .map(|(number, share)| {
                let f_hz = f64::from(number) * base_hz;
                let tone = Tone {
                    f_hz,
                    amplitude: share * Tone::amplitude_for(f_hz, 100.0, scene),
                    phase: draw.uniform(0.0, TAU),
                };
                (number, tone)
            })
            .collect();
        Self { base_hz, lines }
    }

    /// The lines.
    pub fn lines(&self) -> impl Iterator<Item = &Tone> {
        self.lines.iter().map(|(_, tone)| tone)
    }

    /// The same hum `factor` times as large.
    pub fn times(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        for (_, tone) in &mut scaled.lines {
            *tone = tone.scaled(factor);
        }
        scaled
    }
}

impl Effect for Hum {
    fn truths(&self) -> Vec<Truth> {
        let mut parameters = vec![("f_hz".to_owned(), self.base_hz)];
        for (number, tone) in &self.lines {
            parameters.push((format!("amplitude_{number}"), tone.amplitude));
        }
        vec![Truth {
            effect: "hum",
            parameters,
        }]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(self.times(factor))
    }

    /// All lines together over bases within 1 Hz of 50 and of 60; and each line by itself at its
    /// place among ten harmonics. The rival is a hum without the weakest line.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let energies: Vec<f64> = self.lines().map(|tone| tone.energy(scene)).collect();
        let (sum, least) = (
            energies.iter().sum(),
            energies.iter().copied().fold(f64::INFINITY, f64::min),
        );
        let together = power(
            sum,
            2.0 * energies.len() as f64,
            2.0 * 2.0 * 2.2 * scene.duration_s(),
        );
        Evidence {
            power: together.min(power(least, 2.0, 10.0)),
            rival_error: Contrast::shift(least).error(),
        }
    }

    fn tones(&self, scene: &Scene, _draw: &mut Draw, gain: Gain<'_>) -> Option<Vec<f64>> {
        let mut samples = vec![0.0; scene.samples];
        for tone in self.lines() {
            let behind = tone.scaled(gain(tone.f_hz));
            behind.add_to(&mut samples, scene.rate_hz);
        }
        Some(samples)
    }
}
