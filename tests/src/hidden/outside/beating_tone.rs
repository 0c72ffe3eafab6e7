//! A tone whose frequency sways over some hertz and whose size beats, through zero: not a wandering line, whose
//! size is steady, and not the Gaussian noise of a resonance either.

use std::f64::consts::TAU;

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Effect;
use crate::hidden::ideal::detector::Evidence;
use crate::hidden::ideal::grid::{Feature, Grid};
use crate::hidden::ideal::spectral::contrast;
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct BeatingTone {
    f_hz: f64,
    swing_hz: f64,
    amplitude: f64,
    /// Swings a record, and phase, of three waves of the frequency.
    waves: [(f64, f64); 3],
    /// Beats a record.
    beats: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let f_hz = draw.log_uniform(65.0, 500.0);
    let mut wave = || (draw.uniform(3.0, 20.0), draw.uniform(0.0, TAU));
    let waves = [wave(), wave(), wave()];
    Box::new(BeatingTone {
        f_hz,
        swing_hz: f_hz * draw.uniform(0.02, 0.1),
        amplitude: 1e-3,
        waves,
        beats: draw.uniform(40.0, 120.0),
    })
}

impl Effect for BeatingTone {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "beating_tone",
            &[
                ("f_hz", self.f_hz),
                ("swing_hz", self.swing_hz),
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

    /// As noise that fills the band of the swing evenly.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let feature = Feature {
            f_hz: self.f_hz,
            width_hz: self.swing_hz,
        };
        let grid = Grid::new(scene, &[feature]);
        let filled = 0.25 * self.amplitude.powi(2) / (2.0 * self.swing_hz);
        let truth = grid.at(|f_hz| {
            let inside = (f_hz - self.f_hz).abs() < self.swing_hz;
            let passed = scene.chain.power(f_hz, scene.rate_hz);
            scene.density(scene.target, f_hz) + if inside { filled * passed } else { 0.0 }
        });
        let trials = 10.0 * 0.5 * scene.rate_hz / self.swing_hz;
        let seen = contrast(&truth, &grid.base(scene, |_| 1.0), &grid);
        Evidence::power(seen.power(3.0, trials))
    }

    fn waveform(&self, scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        let mut phase = 0.0_f64;
        let samples = (0..scene.samples).map(|i| {
            let at = i as f64 / scene.samples as f64;
            let sway: f64 = self
                .waves
                .iter()
                .map(|(cycles, start)| (TAU * cycles * at + start).sin() / 3.0)
                .sum();
            phase += TAU * (self.f_hz + self.swing_hz * sway) / scene.rate_hz;
            let size = std::f64::consts::SQRT_2 * (0.5 * TAU * self.beats * at).sin();
            size * self.amplitude * phase.cos()
        });
        Some(samples.collect())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Band(
            self.f_hz - self.swing_hz,
            self.f_hz + self.swing_hz,
        ))
    }
}
