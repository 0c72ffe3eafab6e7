//! Isolated samples that are off: Poisson in time, normal in size, behind the chain.

use std::f64::consts::TAU;

use super::{Distorts, Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::Contrast;

struct Outliers {
    rate_hz: f64,
    size: f64,
}

/// 50 to 2000 of them in a record, of a short one no more than a hundredth.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let (least, most) = match scene.relative {
        true => (20.0, (0.01 * scene.samples as f64).min(2000.0)),
        false => (50.0, 2000.0),
    };
    Box::new(Outliers {
        rate_hz: draw.log_uniform(least, most) / scene.duration_s(),
        size: 1e-2,
    })
}

impl Effect for Outliers {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "outliers",
            &[("rate_hz", self.rate_hz), ("size", self.size)],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            size: self.size * factor,
            ..*self
        })
    }

    /// The law of a sample about what its neighbours say of it, a mixture, against the normal
    /// law of the same variance. Samples count as independent. Trials: sizes and rates, about
    /// twenty.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let noise = scene.interpolation_variance(scene.target);
        let share = self.rate_hz / scene.rate_hz;
        let seen = mixture_contrast(share, (self.size.powi(2) + noise) / noise);
        let all = scene.samples as f64;
        let seen = Contrast {
            mean: all * seen.mean,
            variance: all * seen.variance,
        };
        Evidence::power(seen.power(2.0, 20.0))
    }

    fn distort(
        &self,
        samples: &mut Vec<f64>,
        scene: &Scene,
        draw: &mut Draw,
    ) -> Vec<(String, f64)> {
        let mut t_s = draw.exponential(1.0 / self.rate_hz);
        while let Some(sample) = samples.get_mut((t_s * scene.rate_hz) as usize) {
            *sample += self.size * draw.normal();
            t_s += draw.exponential(1.0 / self.rate_hz);
        }
        Vec::new()
    }

    fn distorts(&self, _scene: &Scene) -> Distorts {
        Distorts::Adds
    }
}

/// Twice the log-ratio of one sample: `share` of variance `wide`, the rest of variance one,
/// against one normal law. By the trapezium rule in the logarithm of the distance, since what
/// counts lies between a thousandth and ten times the wide deviation.
fn mixture_contrast(share: f64, wide: f64) -> Contrast {
    const POINTS: u32 = 4000;
    let normal = |x: f64, variance: f64| (-0.5 * x * x / variance).exp() / (TAU * variance).sqrt();
    let total = 1.0 + share * (wide - 1.0);
    let (from, to) = (1e-4_f64.ln(), (12.0 * wide.sqrt()).ln());
    let step = (to - from) / f64::from(POINTS);
    let (mut mean, mut square) = (0.0, 0.0);
    for i in 0..=POINTS {
        let x = (from + f64::from(i) * step).exp();
        let truth = (1.0 - share) * normal(x, 1.0) + share * normal(x, wide);
        // Logarithm of the normal law, which may be far too small for a number.
        let rival_log = -0.5 * x * x / total - 0.5 * (TAU * total).ln();
        let log_ratio = 2.0 * (truth.max(f64::MIN_POSITIVE).ln() - rival_log);
        // Both signs of x.
        let weight = 2.0 * truth * x * step;
        mean += weight * log_ratio;
        square += weight * log_ratio * log_ratio;
    }
    Contrast {
        mean,
        variance: square - mean * mean,
    }
}
