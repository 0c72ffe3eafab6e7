//! Noise that is switched between two strengths at a fixed beat.

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Effect;
use crate::hidden::ideal::detector::Evidence;
use crate::hidden::ideal::envelope::contrast;
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct Switched {
    period_s: f64,
    duty: f64,
    factor: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    Box::new(Switched {
        period_s: draw.log_uniform(1.0, 20.0),
        duty: draw.uniform(0.3, 0.7),
        factor: 1.1,
    })
}

impl Effect for Switched {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "switched",
            &[
                ("period_s", self.period_s),
                ("duty", self.duty),
                ("factor", self.factor),
            ],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            factor: 1.0 + (self.factor - 1.0) * factor,
            ..*self
        })
    }

    /// Trials: all beats between 1 and 20 s, 1/T apart, at ten phases.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let factors: Vec<f64> = (0..100)
            .map(|i| {
                if f64::from(i) < 100.0 * self.duty {
                    self.factor
                } else {
                    1.0
                }
            })
            .collect();
        let trials = 10.0 * scene.duration_s();
        Evidence::power(contrast(&factors, scene, scene.target).power(2.0, trials))
    }

    fn envelope(&self, scene: &Scene, _draw: &mut Draw) -> Option<Vec<f64>> {
        let factors = (0..scene.samples).map(|i| {
            let cycles = i as f64 / (scene.rate_hz * self.period_s);
            if cycles.fract() < self.duty {
                self.factor
            } else {
                1.0
            }
        });
        Some(factors.collect())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Variance)
    }
}
