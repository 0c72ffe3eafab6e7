//! Jumps of the level that last: one to three, and no return to an earlier level.

use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::power;
use crate::hidden::ideal::matched::energy;

struct Steps {
    /// Time in seconds and height.
    steps: Vec<(f64, f64)>,
    /// Non-centrality of the weakest, each by itself, at these heights.
    weakest: f64,
}

/// Times between 0.1 and 0.9 of the record, a tenth of it apart; heights within a factor of two;
/// all to one side, so that no level is visited twice.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let count = 1 + draw.index(3);
    let duration_s = scene.duration_s();
    let mut times: Vec<f64> = Vec::new();
    while times.len() < count {
        let time_s = draw.uniform(0.1, 0.9) * duration_s;
        if times.iter().all(|t| (t - time_s).abs() > 0.1 * duration_s) {
            times.push(time_s);
        }
    }
    times.sort_by(f64::total_cmp);
    let side = draw.sign();
    let steps: Vec<(f64, f64)> = times
        .into_iter()
        .map(|time_s| (time_s, 1e-3 * side * draw.log_uniform(0.7, 1.4)))
        .collect();
    let weakest = steps
        .iter()
        .map(|step| energy(&levels(&[*step], scene), scene, scene.target))
        .fold(f64::INFINITY, f64::min);
    Box::new(Steps { steps, weakest })
}

fn levels(steps: &[(f64, f64)], scene: &Scene) -> Vec<f64> {
    (0..scene.samples)
        .map(|i| {
            let t_s = i as f64 / scene.rate_hz;
            let before = steps.iter().filter(|(time_s, _)| *time_s <= t_s);
            before.map(|(_, height)| height).sum()
        })
        .collect()
}

impl Effect for Steps {
    fn truths(&self) -> Vec<Truth> {
        let mut parameters = Vec::new();
        for (i, (time_s, height)) in self.steps.iter().enumerate() {
            parameters.push((format!("time_s_{}", i + 1), *time_s));
            parameters.push((format!("height_{}", i + 1), *height));
        }
        vec![Truth {
            effect: "steps",
            parameters,
        }]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        let steps = self.steps.iter().map(|(time_s, h)| (*time_s, h * factor));
        Box::new(Self {
            steps: steps.collect(),
            weakest: self.weakest * factor * factor,
        })
    }

    /// Each step by itself, mean and ramp fitted too. Trials: in white noise the search over
    /// the time has correlation `1 - |d| / (2 t)`, and `ln(N) z^2` stands for it (Pickands 1969)
    /// at z^2 = 22; as often again as the record is longer than `N / K`, beyond which the walk
    /// hides what is further away.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let base = &scene.axes[scene.target];
        let windows = 1.0 + scene.duration_s() * base.k / base.n;
        let trials = (scene.samples as f64).ln() * 22.0 * windows;
        Evidence::power(power(self.weakest, 1.0, trials))
    }

    fn waveform(&self, scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        Some(levels(&self.steps, scene))
    }
}
