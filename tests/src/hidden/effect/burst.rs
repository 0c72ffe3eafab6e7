//! A stretch of time in which the short-term noise is larger.

use std::ops::Range;

use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::envelope::contrast;

struct Burst {
    from_s: f64,
    to_s: f64,
    factor: f64,
}

/// Samples of the shortest in a record of any kind.
const SHORTEST: f64 = 64.0;

/// 1 s to a tenth of the record long, away from its ends; in a record of any kind from 64 samples on, and
/// one of four touches an end.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let duration_s = scene.duration_s();
    let (shortest_s, longest_s) = scene.times_s((1.0, 0.1 * duration_s), SHORTEST, 10.0);
    let length_s = draw.log_uniform(shortest_s, longest_s);
    let mut from_s = draw.uniform(0.05 * duration_s, 0.95 * duration_s - length_s);
    if scene.relative && draw.chance(0.25) {
        from_s = draw.pick(&[0.0, duration_s - length_s]);
    }
    Box::new(Burst {
        from_s,
        to_s: from_s + length_s,
        factor: 1.1,
    })
}

impl Effect for Burst {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "burst",
            &[
                ("from_s", self.from_s),
                ("to_s", self.to_s),
                ("factor", self.factor),
            ],
        )]
    }

    fn happens_s(&self) -> Option<Range<f64>> {
        Some(self.from_s..self.to_s)
    }

    /// What the factor adds to one.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            factor: 1.0 + (self.factor - 1.0) * factor,
            ..*self
        })
    }

    /// Trials: starts and lengths, four to each octave of each down to 0.1 s.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let share = (self.to_s - self.from_s) / scene.duration_s();
        let points = 2000;
        let inside = ((share * f64::from(points)).round() as usize).max(1);
        let mut factors = vec![1.0; points as usize];
        factors[..inside].fill(self.factor);
        let (least_s, _) = scene.times_s((0.1, 0.0), SHORTEST, 1.0);
        let trials = 16.0 * 2.0 * scene.duration_s() / least_s;
        Evidence::power(contrast(&factors, scene, scene.target).power(1.0, trials))
    }

    fn envelope(&self, scene: &Scene, _draw: &mut Draw) -> Option<Vec<f64>> {
        let inside = self.from_s..self.to_s;
        let factors = (0..scene.samples).map(|i| {
            if inside.contains(&(i as f64 / scene.rate_hz)) {
                self.factor
            } else {
                1.0
            }
        });
        Some(factors.collect())
    }
}
