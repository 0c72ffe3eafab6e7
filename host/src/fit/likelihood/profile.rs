//! Intervals and tests of one square from its profile likelihood.
//!
//! The profile is the greatest likelihood that the other squares reach for a given value of this
//! one. Twice its fall below the maximum follows the chi-squared law of one degree of freedom at
//! the true value (Wilks 1938), after division by what the correlation between bins adds to the
//! variance. A square that truly is zero comes out positive in half of the cases, which halves the
//! size of its test (Self and Liang 1987), and where its unbounded estimate would be negative its
//! interval is only wider than need be. But it disturbs the intervals of the *other* squares, whose
//! estimates then have no simple law: where a square is at zero, their intervals are the wider
//! ones of this profile and of the one without bounds.
//!
//! - S. S. Wilks, *The large-sample distribution of the likelihood ratio*, Ann. Math. Statist. 9
//!   (1938).
//! - S. G. Self and K.-Y. Liang, *Asymptotic properties of maximum likelihood estimators and
//!   likelihood ratio tests under nonstandard conditions*, J. Am. Stat. Assoc. 82 (1987).

use super::data::Data;
use super::information;
use super::scoring::{Fit, Range, greatest_beside};
use crate::numeric::mixture::add_mixture;
use crate::numeric::normal::ONE_SIDED_95;

/// Fall at the ends of a two-sided 95 % interval: chi-squared of one degree of freedom.
pub const FALL_TWO_SIDED: f64 = 3.841_458_820_694_124;

/// Fall at a one-sided 95 % bound, and the least that a component must gain to be found in a test
/// of 5 %.
pub const FALL_ONE_SIDED: f64 = 2.705_543_454_095_416;

/// What the skewness of a gamma law of `n` degrees of freedom shifts the signed root of the fall
/// by, times the root of `n`: a third of the law's own relative deviation.
const SKEWNESS: f64 = std::f64::consts::SQRT_2 / 3.0;

/// Steps of the search for an end of an interval; regula falsi on the root of the fall, which is
/// nearly straight, needs six.
const STEPS: usize = 60;

/// Relative accuracy of the fall at an end.
const CLOSE: f64 = 1e-4;

/// The profile of one component of a fit.
pub struct Profile<'a> {
    data: &'a Data,
    component: &'a [f64],
    others: Vec<Vec<f64>>,
    /// Variance of the square over what it would be if bins were independent.
    stretch: f64,
    /// Standard deviation of the square.
    deviation: f64,
    within_bounds: Branch,
    /// Where another square is at its bound.
    without: Option<Branch>,
}

/// A maximum from which a profile falls.
struct Branch {
    range: Range,
    best: f64,
    others: Vec<f64>,
    log_likelihood: f64,
}

impl<'a> Profile<'a> {
    /// Profile of the component `index` of the best `fit` of `components`.
    pub fn new(data: &'a Data, components: &'a [Vec<f64>], fit: &Fit, index: usize) -> Self {
        let plain = information::inverse(&fit.information)[(index, index)];
        let stretch = fit.covariance[(index, index)] / plain;
        let branch = |range: Range, squared: &[f64], log_likelihood: f64| {
            let mut others = squared.to_vec();
            Branch {
                range,
                best: others.remove(index),
                others,
                log_likelihood,
            }
        };
        let within_bounds = branch(Range::NonNegative, &fit.squared, fit.log_likelihood);
        let without = within_bounds.others.contains(&0.0).then(|| {
            let nothing = vec![0.0; data.len()];
            let start = Some(&fit.squared[..]);
            greatest_beside(data, components, &nothing, start, Range::Any)
        });
        let mut others = components.to_vec();
        others.remove(index);
        Self {
            data,
            component: &components[index],
            others,
            stretch: if stretch > 0.0 { stretch } else { 1.0 },
            deviation: fit.covariance[(index, index)].sqrt(),
            within_bounds,
            without: without
                .flatten()
                .map(|(squared, value)| branch(Range::Any, &squared, value)),
        }
    }

    /// Twice the fall of the log-likelihood from its maximum, if this square is `value` and the
    /// others are not negative; divided by what the correlation between bins adds.
    pub fn fall(&self, value: f64) -> f64 {
        self.fall_from(&self.within_bounds, value)
    }

    /// Where the profile has fallen by `fall` below the best value; zero where it does not fall as
    /// far.
    pub fn lower(&self, fall: f64) -> f64 {
        self.branches()
            .map(|branch| {
                if branch.best <= 0.0 {
                    return 0.0;
                }
                let at_zero = self.fall_from(branch, 0.0);
                if at_zero <= fall {
                    return 0.0;
                }
                self.end(branch, fall, 0.0, at_zero)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Where it has fallen by `fall` above the best value; infinite where it never does.
    pub fn upper(&self, fall: f64) -> f64 {
        self.branches()
            .map(|branch| {
                let mut step = fall.sqrt() * self.deviation;
                if !(step > 0.0 && step.is_finite()) {
                    return f64::INFINITY;
                }
                for _ in 0..STEPS {
                    let value = branch.best + step;
                    let there = self.fall_from(branch, value);
                    if there >= fall {
                        return self.end(branch, fall, value, there);
                    }
                    step *= 2.0;
                }
                f64::INFINITY
            })
            .fold(0.0, f64::max)
    }

    /// One-sided 95 % bound; infinite where the data set none.
    ///
    /// A square just beyond its bound is known to a half or so: it rests on few degrees of freedom,
    /// whose law is skewed, so that estimates far too low are more frequent than the chi-squared
    /// law of the fall says. The bound is moved up by what that is for a gamma law with the same
    /// relative deviation.
    pub fn bound(&self) -> f64 {
        let first = self.upper(FALL_ONE_SIDED);
        if !first.is_finite() {
            return first;
        }
        let dof = 2.0 * (first / self.deviation_at(first)).powi(2);
        let shift = SKEWNESS / dof.max(1.0).sqrt();
        self.upper((ONE_SIDED_95 + shift).powi(2))
    }

    /// Standard deviation that the estimate would have, if this square were `value`.
    fn deviation_at(&self, value: f64) -> f64 {
        let fixed: Vec<f64> = self.component.iter().map(|one| value * one).collect();
        let start = Some(&self.within_bounds.others[..]);
        let others = greatest_beside(self.data, &self.others, &fixed, start, Range::NonNegative);
        let Some((squared, _)) = others else {
            return self.deviation;
        };
        let mut expected = fixed;
        add_mixture(&mut expected, &self.others, &squared);
        let mut all = vec![self.component.to_vec()];
        all.extend(self.others.iter().cloned());
        information::covariance(self.data, &all, &expected)[(0, 0)].sqrt()
    }

    fn branches(&self) -> impl Iterator<Item = &Branch> {
        std::iter::once(&self.within_bounds).chain(&self.without)
    }

    fn fall_from(&self, branch: &Branch, value: f64) -> f64 {
        let fixed: Vec<f64> = self.component.iter().map(|one| value * one).collect();
        let greatest = |start| {
            greatest_beside(self.data, &self.others, &fixed, start, branch.range)
                .map_or(f64::NEG_INFINITY, |(_, value)| value)
        };
        // From the best fit of all, and from scratch in case the others must change a lot.
        let best = greatest(Some(&branch.others)).max(greatest(None));
        2.0 * (branch.log_likelihood - best).max(0.0) / self.stretch
    }

    /// The end between the best value and `far`, where the fall is `at_far`.
    fn end(&self, branch: &Branch, fall: f64, far: f64, at_far: f64) -> f64 {
        let goal = fall.sqrt();
        let (mut inside, mut outside) = ((branch.best, -goal), (far, at_far.sqrt() - goal));
        if !outside.1.is_finite() {
            outside.1 = goal;
        }
        let mut last_kept = 0;
        for _ in 0..STEPS {
            let share = inside.1 / (inside.1 - outside.1);
            let value = inside.0 + share * (outside.0 - inside.0);
            let excess = self.fall_from(branch, value).sqrt() - goal;
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
