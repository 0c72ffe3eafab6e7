//! The ramp: a slope with its uncertainty, from the same likelihood as everything else.
//!
//! A straight line does not show in the bins; it is taken out of them. What is left of the record
//! is its slope, whose estimate is Gaussian about the ramp with a variance that is linear in the
//! squared coefficients ([`super::slope`]). So for a supposed ramp the squared difference to the
//! estimate is one more bin with one degree of freedom, and the profile likelihood of the ramp
//! follows with the walk and all else free. Where the walk is itself known from few ordinates
//! only, the law of the profile's fall is that of Student's t rather than of a Gaussian.

use nalgebra::DVector;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::data::Data;
use super::scoring::{Fit, Range, greatest_beside};
use super::slope::Slope;
use crate::numeric::bisect::bisect_ratio;

/// Doublings and halvings of the bracket around an end of an interval.
const STEPS: usize = 60;

/// Relative accuracy of an end.
const CLOSE: f64 = 1e-3;

/// Least degrees of freedom of the slope's variance: about as many ordinates show a walk too
/// weak to be seen.
const LEAST_DOF: f64 = 3.0;

/// What a record shows of a ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// The slope, unit of the signal per second, with its sign.
    pub per_s: f64,
    /// Its standard deviation under the best fit.
    pub deviation: f64,
    /// Half of its two-sided 95 % interval.
    pub two_sided: f64,
    /// How far its one-sided 95 % bounds lie from it.
    pub one_sided: f64,
}

impl Ramp {
    /// From the slope of the record and the best `fit` of `components` to its bins.
    ///
    /// `None` where the slope's variance is not a positive number.
    pub fn new(data: &Data, components: &[Vec<f64>], fit: &Fit, slope: &Slope) -> Option<Self> {
        let variance = slope.variance(&fit.squared);
        let unit = fit.expected.last()? / variance;
        if !(unit > 0.0 && unit.is_finite()) {
            return None;
        }
        let profile = Profile {
            data: data.with_bin(0.0, 1.0),
            components: components
                .iter()
                .zip(&slope.unit_variances)
                .map(|(component, variance)| {
                    let last = std::iter::once(unit * variance);
                    component.iter().copied().chain(last).collect()
                })
                .collect(),
            start: &fit.squared,
            unit,
        };
        let dof = dof(fit, slope);
        let law = StudentsT::new(0.0, 1.0, dof).ok()?;
        let end = |share: f64| {
            let t = law.inverse_cdf(share);
            let fall = (dof + 1.0) * (t * t / dof).ln_1p();
            profile.offset(fall, t * variance.sqrt())
        };
        Some(Self {
            per_s: slope.per_s,
            deviation: variance.sqrt(),
            two_sided: end(0.975),
            one_sided: end(0.95),
        })
    }

    /// Whether a slope of zero lies outside of the two-sided interval.
    pub fn identified(&self) -> bool {
        self.per_s.abs() > self.two_sided
    }
}

/// Bins, and the squared distance of a supposed slope from its estimate as one more.
struct Profile<'a> {
    data: Data,
    components: Vec<Vec<f64>>,
    /// Squares to start from.
    start: &'a [f64],
    /// Brings squared slopes to the size of the bins.
    unit: f64,
}

impl Profile<'_> {
    fn greatest(&self, offset: f64) -> f64 {
        let mut psd = self.data.psd.clone();
        if let Some(last) = psd.last_mut() {
            *last = self.unit * offset * offset;
        }
        let nothing = vec![0.0; psd.len()];
        let data = self.data.with_psd(psd);
        let range = Range::NonNegative;
        greatest_beside(&data, &self.components, &nothing, Some(self.start), range)
            .map_or(f64::NEG_INFINITY, |(_, value)| value)
    }

    /// Distance from the estimate at which twice the log-likelihood has fallen by `fall`, near
    /// `guess`.
    fn offset(&self, fall: f64, guess: f64) -> f64 {
        let best = self.greatest(0.0);
        let enough = |offset: f64| 2.0 * (best - self.greatest(offset)) >= fall;
        let (mut near, mut far) = (guess, guess);
        for _ in 0..STEPS {
            if enough(far) {
                break;
            }
            near = far;
            far *= 1.5;
        }
        for _ in 0..STEPS {
            if near < far || !enough(near) {
                break;
            }
            far = near;
            near /= 1.5;
        }
        bisect_ratio(near, far, CLOSE, |offset| !enough(offset))
    }
}

/// Degrees of freedom of the slope's variance: twice its square over its own variance (F. E.
/// Satterthwaite, *An approximate distribution of estimates of variance components*, Biometrics 2,
/// 1946).
fn dof(fit: &Fit, slope: &Slope) -> f64 {
    let gradient = DVector::from_row_slice(&slope.unit_variances);
    let scatter = gradient.dot(&(&fit.covariance * &gradient));
    let variance = slope.variance(&fit.squared);
    (2.0 * variance * variance / scatter).clamp(LEAST_DOF, 1e6)
}
