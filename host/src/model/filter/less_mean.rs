//! Samples less their running mean.

use std::collections::VecDeque;

use super::RunningMeans;
use crate::model::effect::Distorter;

/// A running mean that is taken away.
pub struct LessMean {
    mean: RunningMeans,
    /// Samples whose mean has not come yet.
    waiting: VecDeque<f64>,
    /// Means that are of samples before the record's first one.
    ahead: usize,
}

impl LessMean {
    /// Of a mean over so many samples up to the one that is `ahead` of the sample that it is taken from.
    pub fn new(samples: f64, ahead: usize) -> Self {
        Self {
            mean: RunningMeans::new(1, samples),
            waiting: VecDeque::new(),
            ahead,
        }
    }
}

impl Distorter for LessMean {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        self.waiting.extend(samples.iter().copied());
        self.mean.apply(samples);
        let ahead = self.ahead.min(samples.len());
        self.ahead -= ahead;
        samples.drain(..ahead);
        let waiting = self.waiting.drain(..samples.len());
        for (mean, sample) in samples.iter_mut().zip(waiting) {
            *mean = sample - *mean;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_gone_but_for_its_ends_where_the_mean_is_about_the_sample() {
        let mut filter = LessMean::new(5.0, 2);
        let mut made = Vec::new();
        for block in [3, 1, 40, 17] {
            let first = made.len() + filter.waiting.len();
            let mut samples: Vec<f64> = (first..first + block).map(|n| 0.5 * n as f64).collect();
            filter.apply(&mut samples);
            made.append(&mut samples);
        }
        assert_eq!(made.len(), 3 + 1 + 40 + 17 - 2);
        assert!(
            made[2..].iter().all(|value| value.abs() < 1e-12),
            "{made:?}"
        );
    }
}
