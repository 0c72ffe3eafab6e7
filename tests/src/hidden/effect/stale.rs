//! Samples that repeat the one before, at random.

use super::{Distorts, Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::at_least;

struct Stale {
    share: f64,
}

pub fn draw(scene: &Scene, _draw: &mut Draw) -> Box<dyn Effect> {
    Box::new(Stale {
        share: 10.0 / scene.samples as f64,
    })
}

impl Effect for Stale {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new("stale", &[("share", self.share)])]
    }

    /// As many more.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            share: (self.share * factor).min(0.9),
        })
    }

    /// Two in 2^20 samples of 52-bit numbers never repeat by themselves, so one repeat is seen;
    /// three are asked for before a habit is made of it.
    fn evidence(&self, scene: &Scene) -> Evidence {
        Evidence::power(at_least(3, self.share * scene.samples as f64))
    }

    fn distort(
        &self,
        samples: &mut Vec<f64>,
        _scene: &Scene,
        draw: &mut Draw,
    ) -> Vec<(String, f64)> {
        for i in 1..samples.len() {
            if draw.chance(self.share) {
                samples[i] = samples[i - 1];
            }
        }
        Vec::new()
    }

    /// Of a repeat, the difference from the sample that was due is not correlated with a mean over
    /// white noise, nor with one over quantisation noise; with the samples themselves it is, by share.
    fn distorts(&self, _scene: &Scene) -> Distorts {
        Distorts::Adds
    }
}
