//! The five terms by likelihood: values, intervals, and what cannot be told.

use serde::Serialize;

use super::components::{SEEN, unit_expectations};
use super::data::Data;
use super::profile::{FALL_ONE_SIDED, FALL_TWO_SIDED, Profile};
use super::ramp::Ramp;
use super::scoring::{Fit, maximise};
use super::slope::{Slope, blocks};
use super::{information, longer};
use crate::fit::design::Design;
use crate::model::{Coefficient, PerCoefficient};
use crate::spectrum::{Cascade, Estimate};

/// Correlation of two squares from which they are named as tied.
pub const TIED: f64 = 0.9;

/// Bins below which nothing is fitted: as many as there are terms, and a residual.
const LEAST_BINS: usize = 6;

/// What the likelihood says of one coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LikelihoodValue {
    /// The coefficient; `None` where it cannot be told from zero.
    pub value: Option<f64>,
    /// Lower end of its 95 % interval; zero where the data do not exclude it.
    pub lo: f64,
    /// Upper end of its 95 % interval; `None` where the data set none.
    pub hi: Option<f64>,
    /// Whether it was told from zero, in a test of 5 %.
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
    /// Pairs whose squares have a correlation beyond [`TIED`]: the data tell their combination
    /// better than either.
    pub tied: Vec<[&'static str; 2]>,
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
    let components = unit_expectations(estimate, design);
    let fit = maximise(&data, &components)?;
    let duration_s = cascade.samples() as f64 / rate_hz;
    let squares = per_coefficient(&fit.squared);
    let square = |index: usize| {
        let profile = Profile::new(&data, &components, &fit, index);
        let identified = profile.fall(0.0) > FALL_ONE_SIDED;
        let hi = profile.upper(FALL_TWO_SIDED).sqrt();
        let bound = || profile.upper(FALL_ONE_SIDED).sqrt();
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
        .and_then(|slope| Ramp::new(&data, &components, &fit, &slope));
    let coefficients = PerCoefficient {
        r: of_ramp(ramp, &fit, duration_s),
        k: square(0),
        b: square(1),
        n: square(2),
        q: square(3),
    };
    Some(LikelihoodFit {
        coefficients,
        tied: tied(&fit),
    })
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
