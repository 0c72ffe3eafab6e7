//! A number with its interval.

use serde::Serialize;

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Value {
    /// The best estimate, in the unit of its parameter.
    pub value: f64,
    /// Lower end of its 95 % interval; `None` where it has none.
    pub lo: Option<f64>,
    /// Upper end of its 95 % interval; `None` where it has none.
    pub hi: Option<f64>,
}

/// Standard deviations of a 95 % interval.
const SIGMAS: f64 = 1.959_964;

impl Value {
    /// With the standard deviation `sd`.
    pub fn normal(value: f64, sd: f64) -> Self {
        let end = |end: f64| end.is_finite().then_some(end);
        Self {
            value,
            lo: end(value - SIGMAS * sd),
            hi: end(value + SIGMAS * sd),
        }
    }

    /// The standard deviation that [`Value::normal`] was given; 0 where there is no interval.
    pub fn sd(&self) -> f64 {
        self.hi.map_or(0.0, |hi| (hi - self.value) / SIGMAS)
    }

    /// With the standard deviation `sd` of the logarithm.
    pub fn log_normal(value: f64, sd: f64) -> Self {
        let end = |end: f64| end.is_finite().then_some(end);
        Self {
            value,
            lo: end(value * (-SIGMAS * sd).exp()).filter(|lo| *lo > 0.0),
            hi: end(value * (SIGMAS * sd).exp()),
        }
    }

    /// A number without an interval.
    pub const fn told(value: f64) -> Self {
        Self {
            value,
            lo: None,
            hi: None,
        }
    }

    /// The same of what grows with it: value and ends through an increasing function.
    pub fn map(self, through: impl Fn(f64) -> f64) -> Self {
        Self {
            value: through(self.value),
            lo: self.lo.map(&through),
            hi: self.hi.map(&through),
        }
    }

    /// A number that is known as it is.
    pub const fn exact(value: f64) -> Self {
        Self {
            value,
            lo: Some(value),
            hi: Some(value),
        }
    }
}
