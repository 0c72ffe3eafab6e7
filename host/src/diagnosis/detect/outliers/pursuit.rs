//! Which samples do not belong, and by how much: the highest first.
//!
//! The filter answers a single sample with a hill that may be many samples wide, behind a converter
//! as wide as what its filter shuts out is narrow. Where hills overlap the highest point lies
//! next to both samples, so each new one settles together with those near it: one by one they are put
//! back and sought again where they explain most beside the others, as in the method of S. G. Mallat and Z. Zhang
//! (IEEE Trans. Signal Process. 41 (1993)) with the places refined.

use std::collections::BTreeMap;

use super::nearby::{Height, Nearby, by_distance};
use crate::fft::ring::Series;

/// Samples within which two disturb one another's place: a converter's filter spreads one over as
/// many.
const NEIGHBOURHOOD: usize = 64;

/// Samples by which a place may move at once: a choice, half of [`NEIGHBOURHOOD`].
const MOVE: usize = 32;

/// Times that neighbours settle what is whose, at most: a choice. They rarely move more than twice.
const ROUNDS: usize = 8;

/// Neighbours that settle together, at most: a choice. Where more stand so close, the nearest.
const MOST_NEAR: usize = 12;

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

    /// Explains what is left at `index` by a sample there, or at a place near it that is `usable`
    /// and explains more once those about it have moved.
    pub fn take(&mut self, index: usize, usable: impl Fn(usize) -> bool) {
        self.put(index, self.left[index]);
        let old = self.near(index);
        if old.len() == 1 {
            return;
        }
        let first = old[0].saturating_sub(MOVE);
        let last = (old[old.len() - 1] + MOVE).min(self.left.len() - 1);
        let output: Vec<f64> = (first..=last).map(|at| self.output(&old, at)).collect();
        let output = |at: usize| output[at - first];
        let usable = |at: usize| (first..=last).contains(&at) && usable(at);
        let mut new = old.clone();
        for _ in 0..ROUNDS {
            let before = new.clone();
            for slot in 0..new.len() {
                let place = new.remove(slot);
                let best = self.best(&new, place, usable, output);
                new.insert(slot, best.unwrap_or(place));
            }
            new.sort_unstable();
            self.move_two(&mut new, usable, output);
            if new == before {
                break;
            }
        }
        let Some(settled) = Nearby::new(&self.answer, &new, output) else {
            return;
        };
        let heights = settled.heights();
        for place in old {
            if let Some(height) = self.heights.remove(&place) {
                self.subtract(place, -height);
            }
        }
        for (place, Height { height, .. }) in new.into_iter().zip(heights) {
            self.put(place, height);
        }
    }

    /// Where within reach of a `place` a sample explains most beside `others`; `None` where none does.
    fn best(
        &self,
        others: &[usize],
        place: usize,
        usable: impl Fn(usize) -> bool,
        output: impl Fn(usize) -> f64,
    ) -> Option<usize> {
        let nearby = Nearby::new(&self.answer, others, &output)?;
        let last = (place + MOVE).min(self.left.len() - 1);
        let open =
            (place.saturating_sub(MOVE)..=last).filter(|at| !others.contains(at) && usable(*at));
        let gains = open.map(|at| (at, nearby.gain(at, output(at))));
        let best = gains.max_by(|a, b| a.1.total_cmp(&b.1));
        best.filter(|(_, gain)| *gain > 0.0).map(|(at, _)| at)
    }

    /// Moves each two of some places, ascending, that are next to one another to where both together explain most beside the
    /// others: neighbours that are nearly the same hold one another back.
    fn move_two(
        &self,
        places: &mut [usize],
        usable: impl Fn(usize) -> bool,
        output: impl Fn(usize) -> f64,
    ) {
        /// Samples by which they may move, and how far from one another they may be: choices.
        const NEAR: usize = 8;
        for slot in 1..places.len() {
            let two = [places[slot - 1], places[slot]];
            if two[1] - two[0] > 2 * NEAR {
                continue;
            }
            let others: Vec<usize> = places
                .iter()
                .copied()
                .filter(|at| !two.contains(at))
                .collect();
            let Some(nearby) = Nearby::new(&self.answer, &others, &output) else {
                continue;
            };
            let open = two[0].saturating_sub(NEAR)..=two[1] + NEAR;
            let open: Vec<usize> = open
                .filter(|at| !others.contains(at) && usable(*at))
                .collect();
            if let Some(best) = nearby.best_two(&open, &output) {
                places[slot - 1..=slot].copy_from_slice(&best);
                places.sort_unstable();
            }
        }
    }

    /// Places of those that disturb one at `index`, and its own, ascending.
    fn near(&self, index: usize) -> Vec<usize> {
        let range = index.saturating_sub(NEIGHBOURHOOD)..=index + NEIGHBOURHOOD;
        let mut near: Vec<usize> = self.heights.range(range).map(|(&place, _)| place).collect();
        near.sort_by_key(|place| place.abs_diff(index));
        near.truncate(MOST_NEAR);
        near.sort_unstable();
        near
    }

    /// The filter's output at a place, with nothing of the samples at some places explained.
    fn output(&self, places: &[usize], at: usize) -> f64 {
        let theirs = places
            .iter()
            .map(|&place| self.heights[&place] * by_distance(&self.answer, place, at));
        self.left[at] + theirs.sum::<f64>()
    }

    /// Lets all heights settle at the places they have, each together with those near it; ascending. Those whose height, in
    /// its own standard deviations, is none to `keep` are gone.
    pub fn settle(&mut self, keep: impl Fn(usize, f64) -> bool) -> Vec<(usize, Height)> {
        /// A choice: those far from one another hardly disturb.
        const SWEEPS: usize = 3;
        let mut settled = Vec::new();
        for _ in 0..SWEEPS {
            settled.clear();
            let places: Vec<usize> = self.heights.keys().copied().collect();
            for place in places {
                let near = self.near(place);
                let together = Nearby::new(&self.answer, &near, |at| self.output(&near, at));
                let Some(together) = together else {
                    continue;
                };
                let own = near.partition_point(|one| *one < place);
                let found = together.heights()[own];
                let kept = keep(place, found.height / found.sd);
                let height = if kept { found.height } else { 0.0 };
                self.put(place, height - self.heights[&place]);
                if kept {
                    settled.push((place, found));
                } else {
                    self.heights.remove(&place);
                }
            }
        }
        settled
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
        let found = pursuit.settle(|_, _| true);
        assert_eq!(found.len(), truth.len(), "{found:?}");
        for ((place, Height { height, .. }), (true_place, true_height)) in
            found.into_iter().zip(truth)
        {
            assert_eq!(place, true_place);
            assert!(
                (height - true_height).abs() < 0.01 * true_height.abs(),
                "{height}"
            );
        }
    }

    #[test]
    fn neighbours_that_look_the_same_are_told_apart() {
        // As behind a converter's filter: the filter sees what lies between 0.41 and a half of the rate alone.
        let answer: Vec<f64> = (0..400_i32)
            .map(|lag| {
                let band = std::f64::consts::PI * 0.09 * f64::from(lag);
                let share = if lag == 0 { 1.0 } else { band.sin() / band };
                share * (std::f64::consts::TAU * 0.455 * f64::from(lag)).cos()
            })
            .collect();
        let truth = [(700_usize, -185.0), (701, -303.0), (712, 90.0)];
        let mut output = vec![0.0; 1400];
        for (place, height) in truth {
            for (n, value) in output.iter_mut().enumerate() {
                *value += height * by_distance(&answer, place, n);
            }
        }
        let mut pursuit = Pursuit::new(Series::new(&output), answer);
        while pursuit.len() < 3 {
            let left = pursuit.left();
            let highest = (0..left.len()).max_by(|&a, &b| left[a].abs().total_cmp(&left[b].abs()));
            pursuit.take(highest.unwrap_or(0), |_| true);
        }
        let found = pursuit.settle(|_, z| z.abs() > 5.0);
        let places: Vec<usize> = found.iter().map(|(place, _)| *place).collect();
        assert_eq!(places, truth.map(|(place, _)| place), "{found:?}");
        for ((_, Height { height, sd }), (_, true_height)) in found.into_iter().zip(truth) {
            assert!((height / true_height - 1.0).abs() < 1e-6, "{height}");
            // Neither is known as well as one alone.
            assert!(sd > 1.0, "{sd}");
        }
    }
}
