//! The Allan deviation: measured, expected before and after, simulated.

use rayon::prelude::*;

use crate::bins::point::Point;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::in_record::InRecord;
use crate::diagnosis::result::views::AllanPoint;
use crate::diagnosis::statistic::allan_curve;
use crate::diagnosis::views::passing::Passing;
use crate::model::axis::ModelAxis;

impl AllanPoint {
    /// Whether the five terms alone lie outside of the measured interval.
    pub fn differs_before(&self) -> bool {
        !(self.lo..=self.hi).contains(&self.before)
    }
}

/// The points of an axis, the simulated ones not yet among them.
pub(crate) fn points(
    axis: &AxisState,
    before_and_after: [&ModelAxis; 2],
    own: &InRecord,
    passing: &Passing,
) -> Vec<AllanPoint> {
    let (rate_hz, samples) = (axis.rate_hz, axis.residual.len() as u64);
    let [before, after] = before_and_after.map(|model| model.law(rate_hz));
    let measured = allan_curve::allan(axis.residual.whole(), rate_hz);
    let added = own.adds(|values| {
        let curve = allan_curve::allan(values, rate_hz);
        let at = |one: &Point| curve.iter().find(|point| point.m == one.m);
        let variance = |one: &Point| at(one).map_or(0.0, |point| point.variance);
        measured.iter().map(variance).collect()
    });
    let point = |(number, one): (usize, &Point)| {
        let added = added.get(number).copied().unwrap_or(0.0);
        let of_passing = passing.allan_variance(one.m, |f_hz| after.density(f_hz));
        let steady = (after.allan_variance(one.m) + added).max(0.0);
        let variance = steady + of_passing;
        AllanPoint {
            tau_s: one.tau_s,
            m: one.m,
            adev: one.deviation(),
            lo: one.lo,
            hi: one.hi,
            edf: freedom(
                one.variance,
                [steady, of_passing],
                [one.edf, passing.freedom(one.edf)],
            ),
            intervals: samples / one.m,
            before: before.allan_variance(one.m).sqrt(),
            after: variance.sqrt(),
            simulated: None,
        }
    };
    measured.par_iter().enumerate().map(point).collect()
}

/// Degrees of freedom of a `measured` variance that a model makes of what is steady and of what passes, each with its own.
///
/// Each part of what was measured scatters by itself. A model that is too loud does not excuse itself: of what passes there is no more
/// than was measured beside the rest, and nothing that is missing was it.
fn freedom(measured: f64, [steady, passing]: [f64; 2], [edf, of_passing]: [f64; 2]) -> f64 {
    // A stretch that is quieter takes away: nothing passed then.
    let passed = (measured - steady).min(passing).max(0.0);
    if passed > 0.0 {
        measured.powi(2) / ((measured - passed).powi(2) / edf + passed.powi(2) / of_passing)
    } else {
        edf
    }
}

/// Adds the points of a simulated record.
pub(crate) fn add_simulated(points: &mut [AllanPoint], simulated: &[f64], rate_hz: f64) {
    for one in allan_curve::allan(simulated, rate_hz) {
        if let Some(point) = points.iter_mut().find(|point| point.m == one.m) {
            point.simulated = Some(one.deviation());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_excuses_no_more_than_was_measured_of_it() {
        let own = [1000.0, 1.0];
        // Half of it passed: that is not known, and the other half is.
        let half = freedom(2.0, [1.0, 1.0], own);
        assert!((half - 4.0 / 1.001).abs() < 1e-9, "{half}");
        // A model that is ten times too loud knows the record as well as it is known.
        assert_eq!(freedom(1.0, [1.0, 10.0], own), 1000.0);
        // What is missing is not what passed.
        assert!(freedom(2.0, [1.0, 0.01], own) > 900.0);
        assert_eq!(freedom(2.0, [1.0, 0.0], own), 1000.0);
        // A quieter stretch takes something away.
        assert_eq!(freedom(1.0, [1.1, -0.1], own), 1000.0);
        assert_eq!(freedom(1.2, [1.1, -0.1], own), 1000.0);
    }
}
