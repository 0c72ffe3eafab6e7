//! Coarse steps: every sample rounded to a multiple of a step.

use super::{Distorts, Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;

struct Quantisation {
    step: f64,
    /// Step over the deviation of the short-term noise.
    relative: f64,
}

pub fn draw(scene: &Scene, _draw: &mut Draw) -> Box<dyn Effect> {
    let bins = 2000;
    let spacing_hz = 0.5 * scene.rate_hz / f64::from(bins);
    let variance: f64 = (0..bins)
        .map(|i| scene.short_density(scene.target, (f64::from(i) + 0.5) * spacing_hz))
        .sum::<f64>()
        * 2.0
        * spacing_hz;
    // Walk and flicker alone have no short-term noise but their own differences.
    let variance = match variance > 0.0 {
        true => variance,
        false => scene.interpolation_variance(scene.target),
    };
    Box::new(Quantisation {
        step: variance.sqrt(),
        relative: 1.0,
    })
}

impl Effect for Quantisation {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new("quantisation", &[("step", self.step)])]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            step: self.step * factor,
            relative: self.relative * factor,
        })
    }

    /// An ideal detector sees multiples of any step in numbers of 52 bits. By convention,
    /// strength 1 is where the step starts to matter: at 0.4 of the short-term noise's deviation
    /// the rounding adds 1.3 % of its variance; at 4, ten times that, few codes are left.
    fn evidence(&self, _scene: &Scene) -> Evidence {
        Evidence::power(if self.relative >= 0.4 { 1.0 } else { 0.0 })
    }

    fn distort(
        &self,
        samples: &mut Vec<f64>,
        _scene: &Scene,
        _draw: &mut Draw,
    ) -> Vec<(String, f64)> {
        for sample in samples {
            *sample = (*sample / self.step).round() * self.step;
        }
        Vec::new()
    }

    /// Steps below 1.5 deviations of Gaussian noise leave an error that is correlated with it by
    /// `2 exp(-2 pi^2 / 1.5^2)`, 3e-4 of the variance (Widrow 1956).
    fn distorts(&self, _scene: &Scene) -> Distorts {
        if self.relative < 1.5 {
            Distorts::Adds
        } else {
            Distorts::Beyond
        }
    }
}
