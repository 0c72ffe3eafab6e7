//! Noise that grows and shrinks as a cosine about its mean strength.

use std::f64::consts::TAU;

use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::envelope::contrast;

struct Cyclic {
    /// Swing of the deviation over its mean.
    depth: f64,
    period_s: f64,
    phase_rad: f64,
}

/// Periods from half a second to a twentieth of the record: longer ones are a slow change. Phases keep off half a
/// turn, or an answer just across it would be a whole turn off.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let (from_s, to_s) = scene.times_s((0.5, scene.duration_s() / 20.0), 1000.0, 20.0);
    Box::new(Cyclic {
        depth: 0.1,
        period_s: draw.log_uniform(from_s, to_s),
        phase_rad: draw.uniform(-3.0, 3.0),
    })
}

impl Cyclic {
    fn factor(&self, cycles: f64) -> f64 {
        1.0 + self.depth * (TAU * cycles + self.phase_rad).cos()
    }
}

impl Effect for Cyclic {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "cyclic",
            &[
                ("depth", self.depth),
                ("period_s", self.period_s),
                ("phase_rad", self.phase_rad),
            ],
        )]
    }

    /// Deeper than its mean it cannot be.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            depth: (self.depth * factor).min(1.0),
            ..*self
        })
    }

    /// Trials: all frequencies up to that of half a second, half a cycle a record apart; depth and phase are the
    /// parameters.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let factors: Vec<f64> = (0..100)
            .map(|i| self.factor(f64::from(i) / 100.0))
            .collect();
        let (shortest_s, _) = scene.times_s((0.5, 0.0), 1000.0, 1.0);
        let trials = 2.0 * scene.duration_s() / shortest_s;
        Evidence::power(contrast(&factors, scene, scene.target).power(2.0, trials))
    }

    fn swell(&self) -> f64 {
        1.0 + 0.5 * self.depth * self.depth
    }

    fn envelope(&self, scene: &Scene, _draw: &mut Draw) -> Option<Vec<f64>> {
        let factors = (0..scene.samples)
            .map(|i| self.factor((i as f64 / (scene.rate_hz * self.period_s)).fract()));
        Some(factors.collect())
    }
}
