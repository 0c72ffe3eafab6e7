//! Single samples near one another, explained together.
//!
//! The filter's output at the places `P` of samples of the heights `h` is `y = G h` and noise of the covariance `G`, where `G`
//! holds the filter's answer by the distance between two places: so the likeliest heights are `G^-1 y`, each known to the
//! root of its diagonal element of `G^-1`, and one more sample at `c` explains `r^2 / v`, with `g` the answers between `c`
//! and `P`, `r = y_c - g' G^-1 y` and `v = 1 - g' G^-1 g`; two more explain `r' V^-1 r` likewise. Behind a converter's filter,
//! two neighbours are the same to 1 %, and settling one after the other would never see which is which.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// What is left of a sample's answer beside those near it, at least, as a share of its power, for its height to be
/// known: a choice, as much as the answers themselves are known to.
const LEAST_LEFT: f64 = 1e-3;

/// A height and its standard deviation, in those of one sample alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Height {
    /// The likeliest.
    pub height: f64,
    /// How well it is known.
    pub sd: f64,
}

/// Samples at some places, with what the filter answers at them.
pub struct Nearby<'a> {
    answer: &'a [f64],
    places: &'a [usize],
    factor: Cholesky<f64, Dyn>,
    heights: DVector<f64>,
}

impl<'a> Nearby<'a> {
    /// At these places, by the `output` there of which nothing is explained yet and the filter's `answer` to one sample
    /// by distance; `None` where they cannot be told from one another.
    pub fn new(
        answer: &'a [f64],
        places: &'a [usize],
        output: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let count = places.len();
        let between = DMatrix::from_fn(count, count, |a, b| {
            by_distance(answer, places[a], places[b])
        });
        let factor = between.cholesky()?;
        let seen = DVector::from_iterator(count, places.iter().map(|&place| output(place)));
        let heights = factor.solve(&seen);
        Some(Self {
            answer,
            places,
            factor,
            heights,
        })
    }

    /// The height of each.
    pub fn heights(&self) -> Vec<Height> {
        let variances = self.factor.inverse().diagonal();
        let pairs = self.heights.iter().zip(variances.iter());
        pairs
            .map(|(&height, variance)| Height {
                height,
                sd: variance.sqrt(),
            })
            .collect()
    }

    /// What one more sample at `place`, where the filter's output is `output`, explains; nothing where it is hardly another
    /// than those.
    pub fn gain(&self, place: usize, output: f64) -> f64 {
        let beside = self.beside(place, output);
        if beside.left() < LEAST_LEFT {
            return 0.0;
        }
        beside.remains.powi(2) / beside.left()
    }

    /// The two of some places at which two more samples explain most; `None` where they are hardly others than those.
    pub fn best_two(&self, open: &[usize], output: impl Fn(usize) -> f64) -> Option<[usize; 2]> {
        let beside: Vec<Beside> = open.iter().map(|&at| self.beside(at, output(at))).collect();
        let mut best = (0.0, None);
        for (number, a) in beside.iter().enumerate() {
            for b in &beside[number + 1..] {
                let both = by_distance(self.answer, a.place, b.place) - a.answers.dot(&b.solved);
                let determinant = a.left() * b.left() - both * both;
                if determinant < LEAST_LEFT * a.left().max(b.left()) {
                    continue;
                }
                let squares = b.left() * a.remains.powi(2) + a.left() * b.remains.powi(2);
                let gain = (squares - 2.0 * both * a.remains * b.remains) / determinant;
                if gain > best.0 {
                    best = (gain, Some([a.place, b.place]));
                }
            }
        }
        best.1
    }

    fn beside(&self, place: usize, output: f64) -> Beside {
        let answers = self
            .places
            .iter()
            .map(|&one| by_distance(self.answer, one, place));
        let answers = DVector::from_iterator(self.places.len(), answers);
        Beside {
            place,
            remains: output - answers.dot(&self.heights),
            solved: self.factor.solve(&answers),
            answers,
        }
    }
}

/// A place beside some that are explained.
struct Beside {
    place: usize,
    /// What they leave of the output there.
    remains: f64,
    /// The answers between it and them, and the same over theirs.
    answers: DVector<f64>,
    solved: DVector<f64>,
}

impl Beside {
    /// What they leave of the power of a sample there.
    fn left(&self) -> f64 {
        1.0 - self.answers.dot(&self.solved)
    }
}

/// The filter's answer at one place to a sample at another.
pub fn by_distance(answer: &[f64], a: usize, b: usize) -> f64 {
    answer.get(a.abs_diff(b)).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_those_that_make_the_output_and_known_less_well_the_closer() {
        // Of noise that is its negative of the moment before, mostly.
        let answer: Vec<f64> = (0..300).map(|lag| (-0.9_f64).powi(lag)).collect();
        let truth = [(10_usize, 4.0), (11, -6.0), (250, 2.0)];
        let output = |at: usize| -> f64 {
            let parts = truth.map(|(place, height)| height * by_distance(&answer, place, at));
            parts.iter().sum()
        };
        let places = truth.map(|(place, _)| place);
        let nearby = Nearby::new(&answer, &places, output).expect("places of their own");
        // Two of the correlation c: 1 / sqrt(1 - c^2) each.
        let close = (1.0 - 0.9_f64.powi(2)).sqrt().recip();
        for (found, ((_, height), sd)) in nearby
            .heights()
            .into_iter()
            .zip(truth.into_iter().zip([close, close, 1.0]))
        {
            assert!((found.height - height).abs() < 1e-12, "{found:?}");
            assert!((found.sd - sd).abs() < 1e-9, "{found:?}");
        }
        // Nothing is left for another sample, and one in the same place is no other.
        assert!(nearby.gain(12, output(12)) < 1e-20);
        assert_eq!(nearby.gain(10, 7.0), 0.0);
        assert!(Nearby::new(&answer, &[10, 10], output).is_none());
        // Beside the third the first two explain all of the rest.
        let third = Nearby::new(&answer, &places[2..], output).expect("one place");
        let open: Vec<usize> = (5..16).collect();
        assert_eq!(third.best_two(&open, output), Some([10, 11]));
    }
}
