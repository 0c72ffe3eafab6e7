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
        // Each part of what was measured scatters by its own. A model that is too loud does not excuse itself: of what passes
        // there is no more than was measured beside the rest, and nothing that is missing was it.
        let passed = (one.variance - steady).max(0.0).min(of_passing);
        let scatter =
            (one.variance - passed).powi(2) / one.edf + passed.powi(2) / passing.freedom(one.edf);
        AllanPoint {
            tau_s: one.tau_s,
            m: one.m,
            adev: one.deviation(),
            lo: one.lo,
            hi: one.hi,
            edf: if of_passing > 0.0 {
                one.variance.powi(2) / scatter
            } else {
                one.edf
            },
            intervals: samples / one.m,
            before: before.allan_variance(one.m).sqrt(),
            after: variance.sqrt(),
            simulated: None,
        }
    };
    measured.par_iter().enumerate().map(point).collect()
}

/// Adds the points of a simulated record.
pub(crate) fn add_simulated(points: &mut [AllanPoint], simulated: &[f64], rate_hz: f64) {
    for one in allan_curve::allan(simulated, rate_hz) {
        if let Some(point) = points.iter_mut().find(|point| point.m == one.m) {
            point.simulated = Some(one.deviation());
        }
    }
}
