//! How much an effect changes: significance is not size.

use std::sync::Arc;

use rayon::prelude::*;

use crate::bins::point::Point;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::{Explanation, Snapshot};
use crate::diagnosis::held_out::allan::{Added, AtJumps, HeldCurve};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::statistic::allan_curve;
use crate::model::axis::ModelAxis;
use crate::model::burst::{self, Burst};
use crate::model::effect::Part;

/// Degrees of freedom from which a point of the Allan curve counts: the deviation is then known to
/// 22 %.
const LEAST_EDF: f64 = 10.0;

/// What the extended model of an axis expects of the Allan curve.
pub struct Sizes<'a> {
    axis: &'a AxisState,
    held: &'a HeldCurve,
    noise: &'a ModelAxis,
    /// Variances of the noise, each behind the samples of an average, at the points of the curve that count.
    variances: Vec<(u64, f64)>,
    /// What all waveforms add together.
    waves: Arc<Added>,
}

impl<'a> Sizes<'a> {
    /// For the noise and the waveforms of the last model.
    pub fn new(
        axis: &'a AxisState,
        held: &'a HeldCurve,
        noise: &'a ModelAxis,
        last: &Snapshot,
    ) -> Self {
        let law = noise.law(axis.rate_hz);
        let points = held.points.par_iter();
        let points = points.filter(|point| point.edf >= LEAST_EDF);
        Self {
            variances: points
                .map(|point| (point.m, law.allan_variance(point.m)))
                .collect(),
            // What a filter makes of a jump is excluded from tests, but the jump is there.
            waves: held.adds(
                axis,
                &last.waves().cloned().collect::<Vec<_>>(),
                AtJumps::Kept,
            ),
            axis,
            held,
            noise,
        }
    }

    /// Variance of the noise in averages over `m` samples.
    fn noise_at(&self, m: u64) -> f64 {
        let found = self.variances.iter().find(|(other, _)| *other == m);
        found.map_or(f64::NAN, |(_, variance)| *variance)
    }

    /// Largest change of the model's Allan deviation, at any averaging time of ten degrees of freedom
    /// or more, when an effect is taken out and nothing else moves; percent. `None` for what a model
    /// of noise and waveforms does not hold, such as samples that repeat.
    pub fn change_percent(&self, one: &Explanation) -> Option<f64> {
        let mut rest = self.noise.clone();
        let mut own: Vec<Wave> = one.with.waves().cloned().collect();
        match self.axis.effect_number(one) {
            Some(which) if which < rest.effects.len() => {
                rest.effects.remove(which);
                own.clear();
            }
            _ => own.retain(|wave| !one.without.waves().any(|other| other == wave)),
        }
        if one.happened() {
            return self.change_of_stretches(one);
        }
        if one.kind() == burst::KIND {
            let record_s = self.axis.residual.len() as f64 / self.axis.rate_hz;
            let adds = Burst::of(&one.effect.plain()).adds(record_s);
            return Some(100.0 * ((1.0 + adds).max(0.0).sqrt() - 1.0).abs());
        }
        if self.axis.effect_number(one).is_none() && own.is_empty() {
            return None;
        }
        let rest = rest.law(self.axis.rate_hz);
        let own = self.held.adds(self.axis, &own, AtJumps::Kept);
        largest(&self.held.points, |point| {
            let (waves, own) = (self.waves.at(point.m), own.at(point.m));
            let with = self.noise_at(point.m) + waves;
            let without = rest.allan_variance(point.m) + waves - own;
            100.0 * ((with / without).sqrt() - 1.0).abs()
        })
    }

    /// The same for what happened in stretches which the held-out half leaves out: by what it adds to the whole
    /// record, as a course or in the mean.
    fn change_of_stretches(&self, one: &Explanation) -> Option<f64> {
        let samples = self.axis.residual.len();
        let mut course = vec![0.0; samples];
        one.waves()
            .iter()
            .for_each(|wave| wave.take_out(&mut course));
        let rate_hz = self.axis.rate_hz;
        let law = self.noise.law(rate_hz);
        let term = match one.kind().part(&one.effect.plain()) {
            Part::Term(term) => term,
            Part::Distortion(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => return None,
        };
        largest(&allan_curve::allan(&course, rate_hz), |point| {
            let without = law.allan_variance(point.m) + self.waves.at(point.m);
            let own = point.variance + term.passing(point.m, samples as u64, rate_hz);
            100.0 * ((1.0 + own / without).sqrt() - 1.0)
        })
    }
}

/// The largest change at the points of an Allan curve that count.
fn largest(points: &[Point], change: impl Fn(&Point) -> f64 + Sync) -> Option<f64> {
    let points = points.par_iter().filter(|point| point.edf >= LEAST_EDF);
    let changes = points.map(&change).filter(|change| change.is_finite());
    changes.reduce_with(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_an_allan_deviation_is_hardly_known_nothing_changes_it() {
        let point = |m: u64, edf: f64| Point {
            m,
            tau_s: 1.0,
            variance: 1.0,
            terms: 1,
            stride: 1,
            edf,
            lo: 1.0,
            hi: 1.0,
            bridged: false,
            white_bias: 1.0,
        };
        let points = [point(1, 100.0), point(2, 10.0), point(3, 9.9)];
        assert_eq!(largest(&points, |point| point.m as f64), Some(2.0));
    }
}
