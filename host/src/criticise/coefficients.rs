//! The five coefficients of a fit, with intervals.

use super::axis::AxisState;
use super::finding::Coefficient;
use super::rounds::Accepted;
use crate::fit::likelihood::Fit;
use crate::fit::likelihood::components::SEEN;
use crate::fit::likelihood::ramp::Ramp;
use crate::model::PerCoefficient;

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

/// Density of what the named effects add evenly to the noise, where it shows as white noise of the
/// sensor's: the rounding of a step that was found.
pub fn even_density(axis: &AxisState, accepted: &[Accepted]) -> f64 {
    let joins_behind = axis.frame.units().len() > SEEN.len();
    let step = accepted
        .iter()
        .find(|one| one.effect == "quantisation")
        .and_then(|one| one.parameters.get("step"));
    step.filter(|_| !joins_behind)
        .map_or(0.0, |step| step.value * step.value / 12.0 / axis.rate_hz)
}
