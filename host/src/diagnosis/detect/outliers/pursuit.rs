//! Which samples do not belong, and by how much: the highest first.
//!
//! The filter answers a single sample with a hill that may be many samples wide, behind a converter
//! as wide as what its filter shuts out is narrow. Where two hills overlap the highest point lies
//! next to both samples, so each new one settles together with those near it: one by one they are put
//! back and sought again, as in the method of S. G. Mallat and Z. Zhang (IEEE Trans. Signal Process.
//! 41 (1993)) with the places refined.

use std::collections::BTreeMap;

use crate::fft::ring::Series;

/// Samples within which two disturb one another's place: a converter's filter spreads one over as
/// many.
const NEIGHBOURHOOD: usize = 64;

/// Samples by which a place may move at once: a choice, half of [`NEIGHBOURHOOD`].
const MOVE: usize = 32;

/// Times that neighbours settle what is whose, at most: they move in small steps. Thirty are a
/// choice.
const ROUNDS: usize = 30;

/// A filter's output on its way to be explained by single samples.
pub struct Pursuit {
    /// What is left of the output.
    left: Series,
    /// The filter's answer to one sample, from that moment on; 1 at first.
    answer: Vec<f64>,
    /// Heights by place.
    heights: BTreeMap<usize, f64>,
}

impl Pursuit {
    /// A filter's `output` of which nothing is explained yet.
    pub fn new(output: Series, answer: Vec<f64>) -> Self {
        Self {
            left: output,
            answer,
            heights: BTreeMap::new(),
        }
    }

    /// What is left of the output.
    pub fn left(&self) -> &[f64] {
        &self.left
    }

    /// How many samples explain the rest.
    pub fn len(&self) -> usize {
        self.heights.len()
    }

    /// Places and heights, ascending.
    pub fn heights(&self) -> impl Iterator<Item = (usize, f64)> {
        self.heights.iter().map(|(&index, &height)| (index, height))
    }

    /// Explains what is left at `index` by a sample there, or at a place near it that is `usable`
    /// and explains more once those about it have moved.
    pub fn take(&mut self, index: usize, usable: impl Fn(usize) -> bool) {
        self.put(index, self.left[index]);
        let near = |all: &BTreeMap<usize, f64>| -> Vec<usize> {
            let range = index.saturating_sub(NEIGHBOURHOOD)..=index + NEIGHBOURHOOD;
            all.range(range).map(|(&place, _)| place).collect()
        };
        if near(&self.heights).len() == 1 {
            return;
        }
        for _ in 0..ROUNDS {
            let before = near(&self.heights);
            for &place in &before {
                let Some(height) = self.heights.remove(&place) else {
                    continue;
                };
                self.subtract(place, -height);
                let last = (place + MOVE).min(self.left.len() - 1);
                let best = (place.saturating_sub(MOVE)..=last)
                    .filter(|&one| usable(one))
                    .max_by(|&a, &b| self.left[a].abs().total_cmp(&self.left[b].abs()))
                    .unwrap_or(place);
                self.put(best, self.left[best]);
            }
            if near(&self.heights) == before {
                break;
            }
        }
    }

    /// Lets all heights settle at the places they have.
    pub fn settle(&mut self) {
        for _ in 0..3 {
            let places: Vec<usize> = self.heights.keys().copied().collect();
            for place in places {
                self.put(place, self.left[place]);
            }
        }
    }

    fn put(&mut self, place: usize, height: f64) {
        *self.heights.entry(place).or_default() += height;
        self.subtract(place, height);
    }

    fn subtract(&mut self, place: usize, height: f64) {
        let first = place.saturating_sub(self.answer.len() - 1);
        let end = (place + self.answer.len()).min(self.left.len());
        let (before, from) = self.left[first..end].split_at_mut(place - first);
        for (value, answer) in from.iter_mut().zip(&self.answer) {
            *value -= height * answer;
        }
        for (value, answer) in before.iter_mut().rev().zip(&self.answer[1..]) {
            *value -= height * answer;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hill of some twenty samples that alternates, as behind a filter with a narrow stop band.
    fn answer() -> Vec<f64> {
        (0..200_i32)
            .map(|lag| (-f64::from(lag * lag) / 800.0).exp() * f64::from(1 - 2 * (lag % 2)))
            .collect()
    }

    #[test]
    fn overlapping_hills_are_told_apart() {
        let truth = [(500_usize, 30.0), (540, -25.0), (1200, 12.0)];
        let mut output = vec![0.0; 2000];
        for (place, height) in truth {
            for (n, value) in output.iter_mut().enumerate() {
                let answer = answer().get(place.abs_diff(n)).copied();
                *value += height * answer.unwrap_or(0.0);
            }
        }
        let mut pursuit = Pursuit::new(Series::new(&output), answer());
        for _ in 0..3 {
            let left = pursuit.left();
            let highest = (0..left.len()).max_by(|&a, &b| left[a].abs().total_cmp(&left[b].abs()));
            pursuit.take(highest.unwrap_or(0), |_| true);
        }
        pursuit.settle();
        let found: Vec<(usize, f64)> = pursuit.heights().collect();
        assert_eq!(found.len(), truth.len(), "{found:?}");
        for ((place, height), (true_place, true_height)) in found.into_iter().zip(truth) {
            assert_eq!(place, true_place);
            assert!(
                (height - true_height).abs() < 0.01 * true_height.abs(),
                "{height}"
            );
        }
    }
}
