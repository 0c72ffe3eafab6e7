//! The five coefficients of a fit, with intervals.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Coefficient;
use crate::diagnosis::result::value::Value;
use crate::fit::likelihood::Fit;
use crate::fit::likelihood::components::SEEN;
use crate::fit::likelihood::ramp::Ramp;
use crate::model::PerCoefficient;
use crate::model::outliers;
use crate::model::rounding::{self, Rounding};

/// Standard deviations of a one-sided 5 % test, and of a 95 % interval.
const ONE_SIDED: f64 = 1.644_854;
const TWO_SIDED: f64 = 1.959_964;

/// Coefficients of a fit, as if its shapes were known.
pub fn coefficients_of(fit: &Fit) -> PerCoefficient<Coefficient> {
    let sd: Vec<f64> = fit
        .covariance
        .diagonal()
        .iter()
        .map(|one| one.sqrt())
        .collect();
    coefficients(&fit.squared, &sd)
}

/// A ramp by its size.
pub fn of_ramp(ramp: &Ramp) -> Coefficient {
    let size = ramp.per_s.abs();
    let identified = ramp.identified();
    let finite = |value: f64| value.is_finite().then_some(value);
    Coefficient {
        value: identified.then_some(size),
        lo: identified.then(|| (size - ramp.two_sided).max(0.0)),
        hi: identified.then_some(size + ramp.two_sided),
        identified,
        upper: finite(size + ramp.one_sided),
    }
}

/// Coefficients of the base components with the squares `squared`, whose standard deviations are
/// `squares_sd`; the ramp has none.
pub fn coefficients(squared: &[f64], squares_sd: &[f64]) -> PerCoefficient<Coefficient> {
    PerCoefficient::from_fn(|letter| {
        let Some(place) = SEEN.iter().position(|seen| *seen == letter) else {
            return Coefficient::default();
        };
        let (squared, sd) = (squared[place], squares_sd[place]);
        let root = |square: f64| square.max(0.0).sqrt();
        let identified = squared > ONE_SIDED * sd;
        Coefficient {
            value: identified.then(|| root(squared)),
            lo: identified.then(|| root(squared - TWO_SIDED * sd)),
            hi: identified.then(|| root(squared + TWO_SIDED * sd)),
            identified,
            upper: Some(root(squared + ONE_SIDED * sd)),
        }
    })
}

/// Density that named effects add evenly to the noise, where it shows as white noise of the sensor's,
/// and its standard deviation: the rounding of a step that was found, and outliers too small to be
/// taken out one by one.
pub fn even_density(axis: &AxisState) -> [f64; 2] {
    // Behind a converter's filter they have a component of their own.
    if axis.bins.units().len() > SEEN.len() {
        return [0.0; 2];
    }
    // Behind other filters rounding is no part of the white noise.
    let within = axis.explanation(rounding::KIND);
    let within = within.filter(|_| axis.floor() == 0.0);
    let rounding = within.map_or(0.0, |one| {
        Rounding::of(&one.effect.plain()).density(axis.rate_hz)
    });
    let small = axis.explanation(outliers::KIND);
    let [small, small_sd] = small.map_or([0.0; 2], |one| small_outliers(axis, &one.effect));
    [rounding + small, small_sd]
}

/// Of outliers of a law, those that are still in the record: their density and its standard deviation.
fn small_outliers(axis: &AxisState, effect: &Estimate) -> [f64; 2] {
    let [Some(rate_hz), Some(size)] = effect.values[..] else {
        return [0.0; 2];
    };
    let duration_s = axis.residual.len() as f64 / axis.rate_hz;
    let seen = axis.residual.outliers().iter();
    let seen = seen.map(|one| one.size * one.size);
    let all = rate_hz.value * size.value * size.value;
    let small = (all - seen.sum::<f64>() / duration_s).max(0.0);
    let log_sd = |value: Value| {
        let ends = value.lo.zip(value.hi);
        ends.map_or(1.0, |(lo, hi)| (hi / lo).ln() / (2.0 * TWO_SIDED))
    };
    let squared = axis.rate_hz * axis.rate_hz;
    // All of them at most.
    let sd = all * log_sd(rate_hz).hypot(2.0 * log_sd(size)).min(1.0);
    [small / squared, sd / squared]
}
