//! How well single samples, or one jump, explain an event.

use super::about::About;
use crate::numeric::product::dot;

/// Errors that are looked at one by one, at most: a choice. What lasts for more of them is neither.
pub const MOST: usize = 1 << 12;

/// What each mean by itself makes of the errors.
pub struct Singles<'a> {
    about: &'a About,
    answers: Vec<Vec<f64>>,
}

impl<'a> Singles<'a> {
    /// About an event; `None` where it is too long.
    pub fn new(about: &'a About) -> Option<Self> {
        let len = about.errors().len();
        (len <= MOST).then(|| Self {
            about,
            answers: (0..len).map(|n| about.answer(n)).collect(),
        })
    }

    /// Twice the gain in log-likelihood of a jump, wherever it is.
    pub fn jump(&self) -> f64 {
        let (errors, level) = (self.about.errors(), self.about.level());
        let level_square = dot(level, level);
        let mut course = vec![0.0; errors.len()];
        // What is 1 from a mean on is 1 there, and from the next on.
        let scores = self.answers.iter().enumerate().rev().map(|(n, answer)| {
            let both = course[n..].iter_mut().zip(answer);
            both.for_each(|(course, answer)| *course += answer);
            let (course, level) = (&course[n..], &level[n..]);
            let square = dot(course, course) - dot(course, level).powi(2) / level_square;
            let product = dot(course, &errors[n..]);
            // From the first on it is the level itself.
            let is_some = n > 0 && square > 0.0;
            if is_some {
                product * product / square
            } else {
                0.0
            }
        });
        scores.fold(0.0, f64::max)
    }

    /// How well single samples explain the errors, `count` of them, the largest first; and the largest error that is left.
    pub fn some(&self, count: usize) -> (f64, f64) {
        let mut left = self.about.errors().to_vec();
        let mut score = 0.0;
        for _ in 0..count {
            let scores = (0..left.len()).map(|n| (n, self.explained(n, &left)));
            let Some((n, (size, best))) = scores.max_by(|a, b| a.1.1.total_cmp(&b.1.1)) else {
                break;
            };
            score += best;
            self.take(n, size, &mut left);
        }
        let largest = left
            .iter()
            .fold(0.0, |most: f64, error| most.max(error.abs()));
        (score, largest)
    }

    /// How much of the level is in the answer of the mean `n`.
    fn of_level(&self, n: usize) -> f64 {
        let level = self.about.level();
        dot(&level[n..], &self.answers[n]) / dot(level, level)
    }

    /// Size of the mean `n` in some errors that hold no level, and twice its gain in log-likelihood.
    fn explained(&self, n: usize, errors: &[f64]) -> (f64, f64) {
        let (answer, level) = (&self.answers[n], self.about.level());
        let product = dot(&errors[n..], answer);
        let square = dot(answer, answer) - dot(&level[n..], answer).powi(2) / dot(level, level);
        if square > 0.0 {
            (product / square, product * product / square)
        } else {
            (0.0, 0.0)
        }
    }

    /// Takes the mean `n` of a `size` out of some errors.
    fn take(&self, n: usize, size: f64, errors: &mut [f64]) {
        let of_level = size * self.of_level(n);
        let answers = errors[n..].iter_mut().zip(&self.answers[n]);
        answers.for_each(|(error, answer)| *error -= size * answer);
        let levels = errors.iter_mut().zip(self.about.level());
        levels.for_each(|(error, level)| *error += of_level * level);
    }
}
