//! Samples that repeat the one before, at random or in runs.

use super::{Distorts, Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::at_least;

struct Stale {
    share: f64,
    /// How many come in a row on average; none where a repeat tells nothing of the next sample.
    run_samples: Option<f64>,
}

/// Means of runs in records of any kind: from where half of the samples in runs are told from half of them at random, two in
/// a row, to where the longest have a hundred.
const RUN_SAMPLES: (f64, f64) = (3.0, 20.0);

/// Ten repeats, or in half of the records of any kind ten runs.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let in_runs = scene.relative && draw.chance(0.5);
    let run_samples = in_runs.then(|| draw.log_uniform(RUN_SAMPLES.0, RUN_SAMPLES.1));
    Box::new(Stale {
        share: 10.0 * run_samples.unwrap_or(1.0) / scene.samples as f64,
        run_samples,
    })
}

impl Stale {
    /// Chances of a repeat behind a fresh sample and behind a repeat.
    fn chances(&self) -> (f64, f64) {
        let again = self.run_samples.map_or(self.share, |run| 1.0 - 1.0 / run);
        (self.share * (1.0 - again) / (1.0 - self.share), again)
    }
}

impl Effect for Stale {
    fn truths(&self) -> Vec<Truth> {
        let run_samples = self.run_samples.map(|run| ("run_samples", run));
        let share = std::iter::once(("share", self.share));
        let parameters: Vec<_> = share.chain(run_samples).collect();
        vec![Truth::new("stale", &parameters)]
    }

    /// As many more.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            share: (self.share * factor).min(0.9),
            ..*self
        })
    }

    /// Two in 2^20 samples of 52-bit numbers never repeat by themselves, so one repeat is seen;
    /// three are asked for before a habit is made of it, and three runs before they are one.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let times = self.share / self.run_samples.unwrap_or(1.0);
        Evidence::power(at_least(3, times * scene.samples as f64))
    }

    fn distort(
        &self,
        samples: &mut Vec<f64>,
        _scene: &Scene,
        draw: &mut Draw,
    ) -> Vec<(String, f64)> {
        let (first, again) = self.chances();
        let mut is_repeat = false;
        for i in 1..samples.len() {
            is_repeat = draw.chance(if is_repeat { again } else { first });
            if is_repeat {
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
