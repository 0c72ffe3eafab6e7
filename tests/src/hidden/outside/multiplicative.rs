//! Noise whose strength is itself a slow noise: the logarithm of its deviation wanders.

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Effect;
use crate::hidden::ideal::detector::Evidence;
use crate::hidden::ideal::envelope::contrast;
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct Multiplicative {
    /// Standard deviation of the logarithm.
    depth: f64,
    time_s: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    Box::new(Multiplicative {
        depth: 0.1,
        time_s: draw.log_uniform(0.1, 5.0),
    })
}

impl Effect for Multiplicative {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "multiplicative",
            &[("depth", self.depth), ("time_s", self.time_s)],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            depth: self.depth * factor,
            ..*self
        })
    }

    /// The strength in every moment is unknown to the detector: what its squares vary beyond
    /// their law, `T / time` independent cells of `time * rate` squares each.
    fn evidence(&self, scene: &Scene) -> Evidence {
        // Deviations at even probabilities of the normal law.
        const NORMAL: [f64; 8] = [-1.534, -0.887, -0.489, -0.157, 0.157, 0.489, 0.887, 1.534];
        let factors = NORMAL.map(|z| (self.depth * z).exp());
        let known = contrast(&factors, scene, scene.target);
        // Non-centrality of one cell about its mean; a variance that is doubled by it is seen
        // with n (r - 1 - ln r) over n cells.
        let cells = scene.duration_s() / (2.0 * self.time_s);
        let r = 1.0 + known.mean / cells;
        let seen = crate::hidden::ideal::detector::Contrast {
            mean: cells * (r - 1.0 - r.ln()),
            variance: 2.0 * cells * (r - 1.0).powi(2),
        };
        Evidence::power(seen.power(2.0, 10.0))
    }

    fn envelope(&self, scene: &Scene, draw: &mut Draw) -> Option<Vec<f64>> {
        let kept = (-1.0 / (self.time_s * scene.rate_hz)).exp();
        let fresh = (1.0 - kept * kept).sqrt();
        let mut level = draw.normal();
        let factors = (0..scene.samples).map(|_| {
            level = kept * level + fresh * draw.normal();
            (self.depth * level).exp()
        });
        Some(factors.collect())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Variance)
    }
}
