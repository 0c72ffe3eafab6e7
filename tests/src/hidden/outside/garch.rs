//! White noise whose variance feeds on itself: a large sample makes the next ones larger (Bollerslev 1986).

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Effect;
use crate::hidden::ideal::detector::{Evidence, power};
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct Garch {
    deviation: f64,
    /// What the last square adds to the variance.
    feeds: f64,
    /// What of the last variance stays.
    stays: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let feeds = draw.uniform(0.05, 0.2);
    // The fourth moment exists: 3 a^2 + 2 a b + b^2 < 1.
    let most = (1.0 - 2.0 * feeds * feeds).sqrt() - feeds;
    Box::new(Garch {
        deviation: 1e-2,
        feeds,
        stays: most - draw.log_uniform(0.003, 0.05),
    })
}

impl Effect for Garch {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "garch",
            &[
                ("deviation", self.deviation),
                ("feeds", self.feeds),
                ("stays", self.stays),
            ],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            deviation: self.deviation * factor,
            ..*self
        })
    }

    /// By the correlation of squares, `r_1 (a + b)^(k-1)` at a lag of `k` samples, diluted by the rest of the
    /// noise: `N sum r_k^2`. Trials: how much feeds and stays, about ten.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let (a, b) = (self.feeds, self.stays);
        let first = a * (1.0 - a * b - b * b) / (1.0 - 2.0 * a * b - b * b);
        let own = self.deviation.powi(2);
        let share = own / (own + scene.interpolation_variance(scene.target));
        let sum = (share * share * first).powi(2) / (1.0 - (a + b).powi(2));
        Evidence::power(power(scene.samples as f64 * sum, 2.0, 10.0))
    }

    /// Ahead of the chain.
    fn waveform(&self, scene: &Scene, _axis: usize, draw: &mut Draw) -> Option<Vec<f64>> {
        let mean = self.deviation.powi(2);
        let mut variance = mean;
        let samples = (0..scene.samples).map(|_| {
            let sample = variance.sqrt() * draw.normal();
            let rest = mean * (1.0 - self.feeds - self.stays);
            variance = rest + self.feeds * sample * sample + self.stays * variance;
            sample
        });
        Some(samples.collect())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Variance)
    }
}
