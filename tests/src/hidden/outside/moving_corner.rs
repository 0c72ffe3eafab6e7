//! Noise whose colour changes: white through a pole whose corner swings slowly.

use std::f64::consts::{PI, TAU};

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Effect;
use crate::hidden::effect::lorentzian::{lorentzian, width_of};
use crate::hidden::ideal::detector::{Contrast, Evidence};
use crate::hidden::ideal::grid::Grid;
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct MovingCorner {
    low_hz: f64,
    high_hz: f64,
    period_s: f64,
    amplitude: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let low_hz = draw.log_uniform(20.0, 60.0);
    Box::new(MovingCorner {
        low_hz,
        high_hz: low_hz * draw.uniform(4.0, 8.0),
        period_s: draw.log_uniform(5.0, 60.0),
        amplitude: 1e-3,
    })
}

/// The same once from one end to the other: half a swing takes the record.
pub fn drifting(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let low_hz = draw.log_uniform(0.01, 0.03) * scene.rate_hz;
    Box::new(MovingCorner {
        low_hz,
        high_hz: low_hz * draw.uniform(4.0, 8.0),
        period_s: 2.0 * scene.duration_s(),
        amplitude: 1e-3,
    })
}

impl MovingCorner {
    fn corner(&self, t_s: f64) -> f64 {
        let share = 0.5 - 0.5 * (TAU * t_s / self.period_s).cos();
        self.low_hz * (self.high_hz / self.low_hz).powf(share)
    }
}

impl Effect for MovingCorner {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "moving_corner",
            &[
                ("low_hz", self.low_hz),
                ("high_hz", self.high_hz),
                ("period_s", self.period_s),
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

    /// The spectrum of the moment against its mean over time.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &[]);
        let moments = 16;
        let (mut mean, mut variance) = (0.0, 0.0);
        for (f_hz, weight) in grid.f_hz.iter().zip(&grid.weight) {
            let passed = scene.chain.power(*f_hz, scene.rate_hz);
            let base = scene.density(scene.target, *f_hz);
            let laws: Vec<f64> = (0..moments)
                .map(|i| {
                    let corner = self.corner(self.period_s * f64::from(i) / f64::from(moments));
                    let width_hz = width_of(1.0 / (TAU * corner));
                    let added = lorentzian(*f_hz, 0.0, width_hz, scene);
                    base + self.amplitude.powi(2) * added * passed
                })
                .collect();
            let steady = laws.iter().sum::<f64>() / f64::from(moments);
            for law in laws {
                let r = law / steady;
                mean += weight * (r - 1.0 - r.ln()) / f64::from(moments);
                variance += 2.0 * weight * (r - 1.0).powi(2) / f64::from(moments);
            }
        }
        let trials = 10.0 * scene.duration_s();
        Evidence::power(Contrast { mean, variance }.power(3.0, trials))
    }

    /// Of steady variance: only the correlation time changes.
    fn waveform(&self, scene: &Scene, _axis: usize, draw: &mut Draw) -> Option<Vec<f64>> {
        let mut level = draw.normal();
        let samples = (0..scene.samples).map(|i| {
            let corner = self.corner(i as f64 / scene.rate_hz);
            let kept = (-2.0 * PI * corner / scene.rate_hz).exp();
            level = kept * level + (1.0 - kept * kept).sqrt() * draw.normal();
            self.amplitude * level
        });
        Some(samples.collect())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Variance)
    }
}
