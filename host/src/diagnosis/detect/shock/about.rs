//! An event and what is about it, whitened by what noise beside it says: how well a course explains it.

use std::ops::Range;

use crate::diagnosis::record::bridge::block_means;
use crate::diagnosis::steady::prediction::Prediction;
use crate::model::random::{Gaussian, Generator, Seed};
use crate::model::shock::Shock;

/// Samples about an event, in means over a few of them, less what can be foretold from those before.
pub struct About {
    /// First sample.
    from: usize,
    /// Samples of a mean.
    factor: usize,
    prediction: Prediction,
    /// Errors of prediction, in their deviations, less what a constant level makes of them.
    errors: Vec<f64>,
    /// What a level of 1 makes of them.
    level: Vec<f64>,
}

/// How well a course explains an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explained {
    /// Its size.
    pub size: f64,
    /// Twice the gain in log-likelihood.
    pub score: f64,
}

/// Noise beside an event, as stretches of samples.
pub struct Beside<'a> {
    /// The record.
    pub values: &'a [f64],
    /// Runs in which nothing happens, ascending.
    pub quiet: &'a [Range<usize>],
    /// Variance of white noise that hardly counts: what a filter shuts out is not foretold to less.
    pub faint: f64,
}

impl Beside<'_> {
    /// What predicts the noise nearest to `event`, in means over `factor` samples; `None` where nothing tells what it is.
    pub fn prediction(&self, event: &Range<usize>, factor: usize) -> Option<Prediction> {
        Prediction::new(&self.stretches(event, factor))
    }

    /// Means over `factor` samples of what is nearest to `event`.
    fn stretches(&self, event: &Range<usize>, factor: usize) -> Vec<Vec<f64>> {
        /// Means that are enough: a choice.
        const ENOUGH: usize = 1 << 13;
        /// Means of a stretch that counts, at least.
        const LEAST: usize = 48;
        let mut reach = 2 * ENOUGH * factor;
        loop {
            let near = event.start.saturating_sub(reach)..event.end + reach;
            let parts = self
                .quiet
                .iter()
                .map(|run| run.start.max(near.start)..run.end.min(near.end));
            let parts = parts.filter(|part| part.end >= part.start + LEAST * factor);
            let mut stretches: Vec<Vec<f64>> = parts
                .map(|part| block_means(&self.values[part], factor))
                .collect();
            let count: usize = stretches.iter().map(Vec::len).sum();
            if count >= ENOUGH || reach > self.values.len() {
                let seed = Seed { seed: 0, stream: 0 };
                let deviation = (self.faint / factor as f64).sqrt();
                let mut noise = Gaussian::new(seed, deviation);
                stretches.iter_mut().for_each(|one| noise.add_to(one));
                return stretches;
            }
            reach *= 4;
        }
    }
}

impl About {
    /// The samples `range` about an `event`, in means over `factor`; `None` where nothing tells what its noise is.
    pub fn new(
        beside: &Beside<'_>,
        event: &Range<usize>,
        range: &Range<usize>,
        factor: usize,
    ) -> Option<Self> {
        let prediction = beside.prediction(event, factor)?;
        let means = block_means(&beside.values[range.clone()], factor);
        let level = prediction.errors(&vec![1.0; means.len()]);
        let first = means.first().copied()?;
        let means: Vec<f64> = means.iter().map(|mean| mean - first).collect();
        let mut about = Self {
            from: range.start,
            factor,
            errors: prediction.errors(&means),
            level,
            prediction,
        };
        let errors = std::mem::take(&mut about.errors);
        about.errors = about.beside_level(errors);
        Some(about)
    }

    /// First sample.
    pub const fn from(&self) -> usize {
        self.from
    }

    /// Samples of a mean.
    pub const fn factor(&self) -> usize {
        self.factor
    }

    /// Errors of prediction, in their deviations.
    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// Numbers of the means that have part in some samples.
    pub fn means_of(&self, samples: &Range<usize>) -> Range<usize> {
        let number = |sample: usize| sample.saturating_sub(self.from) / self.factor;
        let last = self.errors.len();
        number(samples.start).min(last)..(number(samples.end) + 1).min(last)
    }

    fn beside_level(&self, mut errors: Vec<f64>) -> Vec<f64> {
        let size = dot(&errors, &self.level) / dot(&self.level, &self.level);
        errors
            .iter_mut()
            .zip(&self.level)
            .for_each(|(error, level)| *error -= size * level);
        errors
    }

    /// What some means become when they are whitened.
    pub fn whitened(&self, means: &[f64]) -> Vec<f64> {
        self.beside_level(self.prediction.errors(means))
    }

    /// The same beside no level.
    pub fn unlevelled(&self, means: &[f64]) -> Vec<f64> {
        self.prediction.errors(means)
    }

    /// The same of a shock whose times are numbers of samples.
    pub fn of_shock(&self, shock: &Shock) -> Vec<f64> {
        let mut samples = vec![0.0; self.errors.len() * self.factor];
        shock.add_to(self.from as u64, &mut samples, 1.0);
        self.whitened(&block_means(&samples, self.factor))
    }

    /// How well a whitened course explains the errors.
    pub fn explained(&self, course: &[f64]) -> Explained {
        let (square, product) = (dot(course, course), dot(course, &self.errors));
        if square <= 0.0 {
            return Explained {
                size: 0.0,
                score: 0.0,
            };
        }
        Explained {
            size: product / square,
            score: product * product / square,
        }
    }

    /// How well a jump explains them, wherever it is.
    pub fn jump(&self) -> f64 {
        self.best(|after| after)
    }

    /// How well single samples explain them, `count` of them, the largest first; and the largest error that is
    /// left.
    pub fn single_samples(&self, count: usize) -> (f64, f64) {
        let answers = Answers::new(self);
        let mut left = self.errors.clone();
        let mut score = 0.0;
        for _ in 0..count {
            let best = (0..left.len()).max_by(|&a, &b| {
                let [a, b] = [a, b].map(|n| answers.explained(n, &left).score);
                a.total_cmp(&b)
            });
            let Some(best) = best else {
                break;
            };
            let explained = answers.explained(best, &left);
            score += explained.score;
            answers.take(best, explained.size, &mut left);
        }
        let largest = left
            .iter()
            .fold(0.0, |most: f64, error| most.max(error.abs()));
        (score, largest)
    }

    /// The score of the best of all courses that are zero first and then what `after` makes of 1.
    fn best(&self, after: impl Fn(f64) -> f64) -> f64 {
        let len = self.errors.len();
        let mut course = vec![0.0; 2 * len];
        course[len..].fill(after(1.0));
        let answer = &self.prediction.errors(&course)[len..];
        let scores = (1..len).map(|at| {
            let mut here = vec![0.0; len];
            here[at..].copy_from_slice(&answer[..len - at]);
            self.explained(&self.beside_level(here)).score
        });
        scores.fold(0.0, f64::max)
    }
}

/// What single samples become when they are whitened, less what a constant level makes of them: on the same scale as
/// any other course.
struct Answers<'a> {
    /// Of a sample with many before it.
    answer: Vec<f64>,
    level: &'a [f64],
    /// Square of the level's errors.
    level_square: f64,
}

impl<'a> Answers<'a> {
    fn new(about: &'a About) -> Self {
        /// Samples after which an answer is over, at most: a choice.
        const LONGEST: usize = 64;
        let reach = LONGEST.min(about.errors.len());
        let mut one = vec![0.0; 2 * reach];
        one[reach] = 1.0;
        Self {
            answer: about.prediction.errors(&one)[reach..].to_vec(),
            level: &about.level,
            level_square: dot(&about.level, &about.level),
        }
    }

    /// How much of the level is in the answer of the sample `n`.
    fn of_level(&self, n: usize) -> f64 {
        dot(&self.level[n..], &self.answer) / self.level_square
    }

    /// How well the sample `n` explains some errors that hold no level.
    fn explained(&self, n: usize, errors: &[f64]) -> Explained {
        let product = dot(&errors[n..], &self.answer);
        // Near the end of what is there only a part of the answer is.
        let there = &self.answer[..self.answer.len().min(errors.len() - n)];
        let square = dot(there, there) - self.of_level(n).powi(2) * self.level_square;
        if square <= 0.0 {
            return Explained {
                size: 0.0,
                score: 0.0,
            };
        }
        Explained {
            size: product / square,
            score: product * product / square,
        }
    }

    /// Takes a sample of a `size` out of some errors.
    fn take(&self, n: usize, size: f64, errors: &mut [f64]) {
        let of_level = size * self.of_level(n);
        let answers = errors[n..].iter_mut().zip(&self.answer);
        answers.for_each(|(error, answer)| *error -= size * answer);
        let levels = errors.iter_mut().zip(self.level);
        levels.for_each(|(error, level)| *error += of_level * level);
    }
}

/// Sum of products.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
