//! What the fits found of one axis. Absent knowledge is `None`, `null` in JSON.

use serde::Serialize;

use super::likelihood::terms::LikelihoodFit;
use crate::model::PerCoefficient;

/// The fits of one axis; `None` where the record is too short for one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fits {
    /// Eq. 9 to 11 as printed.
    pub published: Option<PerCoefficient<PublishedValue>>,
    /// Weighted by each point's uncertainty, coefficients not negative.
    pub weighted: Option<PerCoefficient<WeightedValue>>,
    /// Error of the model's deviation that the weighted fit had to allow for at every point,
    /// percent; zero where the record follows the five terms.
    pub weighted_allowance_percent: Option<f64>,
    /// By likelihood, from the spectrum.
    pub likelihood: Option<LikelihoodFit>,
}

impl Fits {
    /// Squares of the model to go by: that of the likelihood fit, else of the weighted one.
    pub fn squares(&self) -> Option<PerCoefficient<f64>> {
        let likelihood = self.likelihood.as_ref().map(LikelihoodFit::squares);
        likelihood.or_else(|| {
            let weighted = self.weighted.as_ref()?;
            Some(PerCoefficient::from_fn(|one| weighted.get(one).squared))
        })
    }
}

/// A coefficient of the published fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PublishedValue {
    /// The coefficient; `None` where its square came out negative.
    pub value: Option<f64>,
    /// Its square, as fitted.
    pub squared: f64,
}

impl PublishedValue {
    /// The coefficient whose square was fitted as `squared`.
    pub(crate) fn of_square(squared: f64) -> Self {
        Self {
            value: (squared >= 0.0).then(|| squared.sqrt()),
            squared,
        }
    }
}

/// A coefficient of the weighted fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WeightedValue {
    /// The coefficient; `None` where its square was held at zero.
    pub value: Option<f64>,
    /// Its square, not negative.
    pub squared: f64,
    /// Lower end of its 95 % interval; zero where it is not resolved from zero.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
}
