//! The five terms by likelihood: values, intervals, and what is not resolved.

use serde::Serialize;

use super::components::{SEEN, unit_expectations};
use super::data::Data;
use super::misfit::{Tolerant, maximise_tolerant};
use super::profile::{FALL_ONE_SIDED, FALL_TWO_SIDED, Profile};
use super::ramp::Ramp;
use super::scoring::Fit;
use super::slope::{Slope, blocks};
use super::{information, longer};
use crate::chain::Chain;
use crate::fit::design::Design;
use crate::model::{Coefficient, PerCoefficient};
use crate::spectrum::{Cascade, Estimate, Plan, Settings};

/// Correlation of two squares from which they are named as tied.
pub const TIED: f64 = 0.9;

/// Bins below which nothing is fitted: as many as there are terms, and a residual.
const LEAST_BINS: usize = 6;

/// What the likelihood says of one coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LikelihoodValue {
    /// The coefficient; `None` where it cannot be resolved from zero.
    pub value: Option<f64>,
    /// Lower end of its 95 % interval; zero where the data do not exclude it.
    pub lo: f64,
    /// Upper end of its 95 % interval; `None` where the data set none.
    pub hi: Option<f64>,
    /// Whether it was resolved from zero, in a test of 5 %.
    pub identified: bool,
    /// One-sided 95 % bound, where it was not.
    pub upper: Option<f64>,
    /// How many times longer a record would show it half of the time, if it is what the best
    /// estimate says; `None` where it is identified, or no length would.
    pub record_longer_by: Option<f64>,
    /// Square of the best estimate, identified or not.
    #[serde(skip)]
    pub squared: f64,
}

/// The five terms of one axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LikelihoodFit {
    /// The coefficients.
    #[serde(flatten)]
    pub coefficients: PerCoefficient<LikelihoodValue>,
    /// Pairs whose squares have a correlation beyond [`TIED`]: the data determine their combination
    /// better than either.
    pub tied: Vec<[&'static str; 2]>,
    /// Error of the model's deviation that had to be allowed for at every frequency, percent; zero
    /// where the record follows the five terms.
    pub allowance_percent: f64,
    /// Mean frequencies of bins that were left out because no chance explains them, hertz.
    pub left_out_hz: Vec<f64>,
    /// What each of [`SEEN`] adds to the expectation of every bin of the spectrum, squared unit of
    /// the signal per hertz.
    #[serde(skip)]
    pub parts: [Vec<f64>; SEEN.len()],
}

impl LikelihoodFit {
    /// Squares of the best estimates that make the model; a ramp only where it was resolved from zero.
    pub fn squares(&self) -> PerCoefficient<f64> {
        PerCoefficient::from_fn(|one| {
            let value = self.coefficients.get(one);
            if one == Coefficient::R && !value.identified {
                0.0
            } else {
                value.squared
            }
        })
    }

    /// Expectation of every bin of the spectrum.
    pub fn expected(&self) -> Vec<f64> {
        let bins = self.parts[0].len();
        (0..bins)
            .map(|b| self.parts.iter().map(|part| part[b]).sum())
            .collect()
    }
}

/// Fits the five terms to what `cascade` has seen of an axis, in counts of `units_per_count`;
/// `estimate` is its spectrum.
///
/// `None` where the record is too short or does not move.
pub fn fit(
    cascade: &Cascade,
    estimate: &Estimate,
    units_per_count: f64,
    design: &Design,
) -> Option<LikelihoodFit> {
    if estimate.bins.len() < LEAST_BINS {
        return None;
    }
    let rate_hz = design.rate_hz();
    let data = Data::new(estimate, units_per_count)?;
    let units = unit_expectations(estimate, design);
    let tolerant = maximise_tolerant(&data, &units)?;
    let Tolerant {
        data,
        components,
        fit,
        ..
    } = &tolerant;
    let duration_s = cascade.samples() as f64 / rate_hz;
    let squares = per_coefficient(&fit.squared);
    let square = |index: usize| {
        let profile = Profile::new(data, components, fit, index);
        let identified = profile.fall(0.0) > FALL_ONE_SIDED;
        let hi = profile.upper(FALL_TWO_SIDED).sqrt();
        let bound = || profile.bound().sqrt();
        let squared = fit.squared[index];
        LikelihoodValue {
            value: identified.then(|| squared.sqrt()),
            lo: profile.lower(FALL_TWO_SIDED).sqrt(),
            hi: finite(hi),
            identified,
            upper: if identified { None } else { finite(bound()) },
            record_longer_by: if identified {
                None
            } else {
                longer::for_square(design, &squares, duration_s, index)
            },
            squared,
        }
    };
    let blocks = blocks(cascade, rate_hz, units_per_count);
    let ramp = Slope::new(&blocks, &fit.squared)
        .and_then(|slope| Ramp::new(data, components, fit, &slope));
    let coefficients = PerCoefficient {
        r: of_ramp(ramp, fit, duration_s),
        k: square(0),
        b: square(1),
        n: square(2),
        q: square(3),
    };
    let squared = &fit.squared;
    Some(LikelihoodFit {
        coefficients,
        tied: tied(fit),
        allowance_percent: 50.0 * tolerant.allowance,
        parts: std::array::from_fn(|i| units[i].iter().map(|one| squared[i] * one).collect()),
        left_out_hz: tolerant.left_out_hz.clone(),
    })
}

/// Fits the five terms to values in memory, NaN where missing, in their own unit, as `inm analyze` fits them.
///
/// `None` where they are too few or do not move.
pub fn fit_values(values: &[f64], rate_hz: f64, chain: Option<&Chain>) -> Option<LikelihoodFit> {
    let mut cascade = Cascade::new(&Plan::new());
    cascade.push_values(0, values).ok()?;
    let estimate = Estimate::new(&cascade, rate_hz, &Settings::default());
    fit(&cascade, &estimate, 1.0, &Design::new(rate_hz, chain))
}

fn of_ramp(ramp: Option<Ramp>, fit: &Fit, duration_s: f64) -> LikelihoodValue {
    let Some(ramp) = ramp else {
        // Gaps left no slow record to take a slope from.
        return LikelihoodValue {
            value: None,
            lo: 0.0,
            hi: None,
            identified: false,
            upper: None,
            record_longer_by: None,
            squared: 0.0,
        };
    };
    let size = ramp.per_s.abs();
    let identified = ramp.identified();
    LikelihoodValue {
        value: identified.then_some(size),
        lo: (size - ramp.two_sided).max(0.0),
        hi: finite(size + ramp.two_sided),
        identified,
        // The estimate's size is at least its value in the ramp's own direction, so the bound for
        // one direction holds for both.
        upper: if identified {
            None
        } else {
            finite(size + ramp.one_sided)
        },
        record_longer_by: if identified {
            None
        } else {
            longer::for_slope(size, &fit.squared, duration_s)
        },
        squared: size * size,
    }
}

fn per_coefficient(squared: &[f64]) -> PerCoefficient<f64> {
    PerCoefficient::from_fn(|one| {
        let place = SEEN.iter().position(|&seen| seen == one);
        place.map_or(0.0, |index| squared[index])
    })
}

fn tied(fit: &Fit) -> Vec<[&'static str; 2]> {
    let correlation = information::correlation(&fit.covariance);
    let pairs = (0..SEEN.len()).flat_map(|i| (i + 1..SEEN.len()).map(move |j| (i, j)));
    pairs
        .filter(|&(i, j)| correlation[(i, j)].abs() > TIED)
        .map(|(i, j)| [SEEN[i], SEEN[j]].map(Coefficient::symbol))
        .collect()
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
