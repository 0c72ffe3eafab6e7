//! An event and what is about it, whitened by what noise beside it says: how well a course explains it.

use std::ops::Range;

use crate::diagnosis::steady::gaps::{self, Whitener, missing};
use crate::diagnosis::steady::prediction::{ORDER, Prediction};
use crate::model::random::{Gaussian, Generator, Seed};
use crate::model::shock::Shock;
use crate::numeric::product::dot;

/// Means after which what one makes of the errors is over: those that are foretold from it, and, where some are missing, from
/// what it says of these.
const ANSWER: usize = 2 * ORDER;

/// Samples about an event, in means over a few of them, less what can be foretold from those before.
pub struct About {
    /// First sample.
    from: usize,
    /// Samples of a mean.
    factor: usize,
    /// The samples, no numbers where they are missing.
    values: Vec<f64>,
    /// Means that say nothing.
    is_missing: Vec<bool>,
    prediction: Prediction,
    whitener: Whitener,
    /// Errors of prediction, in their deviations, less what a constant level makes of them; zero where nothing is said.
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
    /// The record; no numbers where samples are missing.
    pub values: &'a [f64],
    /// Runs in which nothing happens, ascending.
    pub quiet: &'a [Range<usize>],
    /// Variance of white noise that hardly counts: what a filter shuts out is not foretold to less.
    pub faint: f64,
}

impl Beside<'_> {
    /// What predicts the noise nearest to `event`, in means over `factor` samples; `None` where nothing tells what it is.
    pub fn prediction(&self, event: &Range<usize>, factor: usize) -> Option<Prediction> {
        let seed = Seed { seed: 0, stream: 0 };
        let mut noise = Gaussian::new(seed, (self.faint / factor as f64).sqrt());
        let mut stretches = self.stretches(event, factor);
        stretches.iter_mut().for_each(|one| noise.add_to(one));
        gaps::prediction(&mut stretches)
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
            let parts = parts.map(|part| means(&self.values[part], factor));
            let is_there = |means: &Vec<f64>| means.iter().any(|mean| mean.is_finite());
            let stretches: Vec<Vec<f64>> = parts.filter(is_there).collect();
            let count: usize = stretches.iter().map(Vec::len).sum();
            if count >= ENOUGH || reach > self.values.len() {
                return stretches;
            }
            reach *= 4;
        }
    }
}

/// Means over `factor` samples each, of those that are there; no number where these are less than half.
fn means(values: &[f64], factor: usize) -> Vec<f64> {
    let mean = |block: &[f64]| {
        let there = block.iter().filter(|value| value.is_finite());
        let count = there.clone().count();
        if 2 * count >= factor {
            there.sum::<f64>() / count as f64
        } else {
            f64::NAN
        }
    };
    values.chunks_exact(factor).map(mean).collect()
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
        let values = &beside.values[range.clone()];
        let is_missing = missing(&means(values, factor));
        Self::of(prediction, values.to_vec(), is_missing, range.start, factor)
    }

    fn of(
        prediction: Prediction,
        values: Vec<f64>,
        is_missing: Vec<bool>,
        from: usize,
        factor: usize,
    ) -> Option<Self> {
        let whitener = Whitener::new(&prediction, &is_missing);
        let level = whitener.errors(&vec![1.0; is_missing.len()]);
        let mut means = means(&values, factor);
        let first = means.iter().copied().find(|mean| mean.is_finite())?;
        means.iter_mut().for_each(|mean| *mean -= first);
        let errors = whitener.errors(&means);
        let mut about = Self {
            from,
            factor,
            values,
            is_missing,
            prediction,
            whitener,
            errors: Vec::new(),
            level,
        };
        about.errors = about.beside_level(errors);
        Some(about)
    }

    /// The same where some `samples` say nothing.
    pub fn without(&self, samples: &[Range<usize>]) -> Option<Self> {
        let mut is_missing = self.is_missing.clone();
        for samples in samples {
            is_missing[self.means_of(samples)].fill(true);
        }
        let prediction = self.prediction.clone();
        Self::of(
            prediction,
            self.values.clone(),
            is_missing,
            self.from,
            self.factor,
        )
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

    /// What a level of 1 makes of them.
    pub fn level(&self) -> &[f64] {
        &self.level
    }

    /// Numbers of the means that have part in some samples.
    pub fn means_of(&self, samples: &Range<usize>) -> Range<usize> {
        let number = |sample: usize| sample.saturating_sub(self.from) / self.factor;
        let last = self.errors.len();
        number(samples.start).min(last)..(number(samples.end) + 1).min(last)
    }

    /// Errors of the means that have part in some samples and say something.
    pub fn errors_in(&self, samples: &Range<usize>) -> Vec<f64> {
        self.said(self.means_of(samples))
    }

    /// How many means say something.
    pub fn count(&self) -> usize {
        self.is_missing
            .iter()
            .filter(|is_missing| !**is_missing)
            .count()
    }

    /// Errors of some means that say something.
    pub fn said(&self, means: Range<usize>) -> Vec<f64> {
        let said = means.filter(|n| !self.is_missing[*n]);
        said.map(|n| self.errors[n]).collect()
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
        self.beside_level(self.whitener.errors(means))
    }

    /// The same beside no level, with nothing missing.
    pub fn unlevelled(&self, means: &[f64]) -> Vec<f64> {
        self.prediction.errors(means)
    }

    /// What a mean of 1 far from any other makes of it and of as many after it as have part in that.
    pub fn answer(&self, mean: usize) -> Vec<f64> {
        let mut one = vec![0.0; ANSWER.min(self.errors.len() - mean)];
        one[0] = 1.0;
        self.whitener.errors_from(mean, &mut one)
    }

    /// The same of a shock whose times are numbers of samples.
    pub fn of_shock(&self, shock: &Shock) -> Vec<f64> {
        let mut samples = vec![0.0; self.errors.len() * self.factor];
        shock.add_to(self.from as u64, &mut samples, 1.0);
        let both = samples.iter_mut().zip(&self.values);
        both.filter(|(_, value)| !value.is_finite())
            .for_each(|(sample, _)| *sample = f64::NAN);
        self.whitened(&means(&samples, self.factor))
    }

    /// Mean square of what a shock leaves of some samples beside a level.
    pub fn left(&self, shock: &Shock, samples: &Range<usize>) -> f64 {
        let last = self.from + self.values.len();
        let place = samples.start.max(self.from)..samples.end.min(last);
        let mut course = vec![0.0; place.len()];
        shock.add_to(place.start as u64, &mut course, 1.0);
        let values = &self.values[place.start - self.from..place.end - self.from];
        let both = values
            .iter()
            .zip(&course)
            .map(|(value, course)| value - course);
        let left: Vec<f64> = both.filter(|one| one.is_finite()).collect();
        let count = left.len() as f64;
        let mean = left.iter().sum::<f64>() / count;
        left.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / count
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
}
