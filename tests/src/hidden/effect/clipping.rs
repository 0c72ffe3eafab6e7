//! Samples held at a limit on one side.

use super::{Distorts, Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::at_least;

struct Clipping {
    /// Samples at or beyond the limit.
    count: f64,
    side: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    Box::new(Clipping {
        count: 10.0,
        side: draw.sign(),
    })
}

impl Effect for Clipping {
    /// The level follows from the samples.
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new("clipping", &[("side", self.side)])]
    }

    /// As many more.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            count: self.count * factor,
            ..*self
        })
    }

    /// Two equal extremes do not happen by themselves; four are asked for.
    fn evidence(&self, _scene: &Scene) -> Evidence {
        Evidence::power(at_least(4, self.count))
    }

    fn distort(
        &self,
        samples: &mut Vec<f64>,
        _scene: &Scene,
        _draw: &mut Draw,
    ) -> Vec<(String, f64)> {
        let mut sorted: Vec<f64> = samples.iter().map(|sample| sample * self.side).collect();
        let count = (self.count.round() as usize).clamp(1, sorted.len() - 1);
        let rank = sorted.len() - count;
        let (_, limit, _) = sorted.select_nth_unstable_by(rank, f64::total_cmp);
        let limit = *limit;
        for sample in samples {
            *sample = (*sample * self.side).min(limit) * self.side;
        }
        vec![("level".to_owned(), limit * self.side)]
    }

    /// Correlated with the samples by twice the share, times the excess of a few in a thousand.
    fn distorts(&self, _scene: &Scene) -> Distorts {
        Distorts::Adds
    }
}
