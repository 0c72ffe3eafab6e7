//! Intervals and tests of one square from its profile likelihood.
//!
//! The profile is the greatest likelihood that the other squares reach for a given value of this
//! one. Twice its fall below the maximum follows the chi-squared law of one degree of freedom at
//! the true value (Wilks 1938), after division by what the correlation between bins adds to the
//! variance. At the bound nothing breaks: where the unbounded estimate would be negative the fall is
//! smaller, so that intervals cover at least what they claim; and a square that truly is zero
//! comes out positive in half of the cases, which halves the size of its test (Self and Liang
//! 1987).
//!
//! - S. S. Wilks, *The large-sample distribution of the likelihood ratio*, Ann. Math. Statist. 9
//!   (1938).
//! - S. G. Self and K.-Y. Liang, *Asymptotic properties of maximum likelihood estimators and
//!   likelihood ratio tests under nonstandard conditions*, J. Am. Stat. Assoc. 82 (1987).

use super::data::Data;
use super::information;
use super::scoring::{Fit, greatest_beside};

/// Fall at the ends of a two-sided 95 % interval: chi-squared of one degree of freedom.
pub const FALL_TWO_SIDED: f64 = 3.841_458_820_694_124;

/// Fall at a one-sided 95 % bound, and the least that a component must gain to be found in a test
/// of 5 %.
pub const FALL_ONE_SIDED: f64 = 2.705_543_454_095_416;

/// Steps of the search for an end of an interval; regula falsi on the root of the fall, which is
/// nearly straight, needs six.
const STEPS: usize = 60;

/// Relative accuracy of the fall at an end.
const CLOSE: f64 = 1e-4;

/// The profile of one component of a fit.
pub struct Profile<'a> {
    data: &'a Data,
    components: &'a [Vec<f64>],
    index: usize,
    fit: &'a Fit,
    /// Variance of the square over what it would be if bins were independent.
    stretch: f64,
}

impl<'a> Profile<'a> {
    /// Profile of the component `index` of the best `fit` of `components`.
    pub fn new(data: &'a Data, components: &'a [Vec<f64>], fit: &'a Fit, index: usize) -> Self {
        let plain = information::inverse(&fit.information)[(index, index)];
        let stretch = fit.covariance[(index, index)] / plain;
        Self {
            data,
            components,
            index,
            fit,
            stretch: if stretch > 0.0 { stretch } else { 1.0 },
        }
    }

    /// Twice the fall of the log-likelihood from its maximum, if this square is `value`; divided by
    /// what the correlation between bins adds.
    pub fn fall(&self, value: f64) -> f64 {
        let fixed: Vec<f64> = self.components[self.index]
            .iter()
            .map(|one| value * one)
            .collect();
        let others: Vec<Vec<f64>> = (0..self.components.len())
            .filter(|&i| i != self.index)
            .map(|i| self.components[i].clone())
            .collect();
        let start: Vec<f64> = (0..self.components.len())
            .filter(|&i| i != self.index)
            .map(|i| self.fit.squared[i])
            .collect();
        // From the best fit of all, and from scratch in case the others must change a lot.
        let best = [Some(&start[..]), None]
            .map(|start| greatest_beside(self.data, &others, &fixed, start))
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max);
        2.0 * (self.fit.log_likelihood - best).max(0.0) / self.stretch
    }

    /// Where the profile has fallen by `fall` below the best value; zero where it does not fall as
    /// far.
    pub fn lower(&self, fall: f64) -> f64 {
        let best = self.fit.squared[self.index];
        if best == 0.0 {
            return 0.0;
        }
        let at_zero = self.fall(0.0);
        if at_zero <= fall {
            return 0.0;
        }
        self.end(fall, best, 0.0, at_zero)
    }

    /// Where it has fallen by `fall` above the best value; infinite where it never does.
    pub fn upper(&self, fall: f64) -> f64 {
        let best = self.fit.squared[self.index];
        let mut step = fall.sqrt() * self.fit.covariance[(self.index, self.index)].sqrt();
        if !(step > 0.0 && step.is_finite()) {
            return f64::INFINITY;
        }
        for _ in 0..STEPS {
            let there = self.fall(best + step);
            if there >= fall {
                return self.end(fall, best, best + step, there);
            }
            step *= 2.0;
        }
        f64::INFINITY
    }

    /// The end between `near` (the best value) and `far`, where the fall is `at_far`.
    fn end(&self, fall: f64, near: f64, far: f64, at_far: f64) -> f64 {
        let goal = fall.sqrt();
        let (mut inside, mut outside) = ((near, -goal), (far, at_far.sqrt() - goal));
        if !outside.1.is_finite() {
            outside.1 = goal;
        }
        let mut last_kept = 0;
        for _ in 0..STEPS {
            let share = inside.1 / (inside.1 - outside.1);
            let value = inside.0 + share * (outside.0 - inside.0);
            let excess = self.fall(value).sqrt() - goal;
            if excess.abs() < CLOSE * goal {
                return value;
            }
            // The Illinois rule: an end that stays twice counts half.
            if excess < 0.0 {
                inside = (value, excess);
                if last_kept == 1 {
                    outside.1 *= 0.5;
                }
                last_kept = 1;
            } else {
                outside = (value, excess);
                if last_kept == -1 {
                    inside.1 *= 0.5;
                }
                last_kept = -1;
            }
        }
        0.5 * (inside.0 + outside.0)
    }
}
