//! How much an effect changes: significance is not size.

use rayon::prelude::*;

use crate::bins::point::Point;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::{Explanation, Snapshot};
use crate::diagnosis::record::in_record::InRecord;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::statistic::allan_curve;
use crate::model::axis::ModelAxis;
use crate::model::burst::{self, Burst};
use crate::model::effect::Part;

/// Degrees of freedom from which a point of the Allan curve counts: the deviation is then known to
/// 22 %.
const LEAST_EDF: f64 = 10.0;

/// What the extended model of an axis expects of the Allan curve of the whole record.
pub struct Sizes<'a> {
    axis: &'a AxisState,
    noise: &'a ModelAxis,
    /// The points that count.
    points: Vec<Point>,
    /// Variances of the noise at them.
    variances: Vec<f64>,
    /// What all waveforms add to those.
    waves: Vec<f64>,
}

impl<'a> Sizes<'a> {
    /// For the noise and the waveforms of the last model.
    pub fn new(axis: &'a AxisState, noise: &'a ModelAxis, last: &Snapshot) -> Self {
        let mut points = allan_curve::allan(axis.residual.whole(), axis.rate_hz);
        points.retain(|point| point.edf >= LEAST_EDF);
        let mut sizes = Self {
            variances: of_noise(noise, axis.rate_hz, &points),
            waves: Vec::new(),
            axis,
            noise,
            points,
        };
        let waves: Vec<Wave> = last.waves().cloned().collect();
        sizes.waves = sizes.added_by(&waves);
        sizes
    }

    /// What some waveforms add at the points.
    fn added_by(&self, waves: &[Wave]) -> Vec<f64> {
        let added = InRecord::of(&self.axis.residual, waves).adds(|values| {
            let curve = allan_curve::allan(values, self.axis.rate_hz);
            let at = |point: &Point| curve.iter().find(|one| one.m == point.m);
            let variance = |point: &Point| at(point).map_or(0.0, |one| one.variance);
            self.points.iter().map(variance).collect()
        });
        if added.is_empty() {
            return vec![0.0; self.points.len()];
        }
        added
    }

    /// Largest change of the model's Allan deviation, at any averaging time of ten degrees of freedom
    /// or more, when an effect is taken out and nothing else moves; percent. `None` for what a model
    /// of noise and waveforms does not hold, such as samples that repeat.
    pub fn change_percent(&self, one: &Explanation) -> Option<f64> {
        let mut rest = self.noise.clone();
        let mut own: Vec<Wave> = one.with.waves().cloned().collect();
        let law = self.axis.effect_number(one);
        match law.filter(|which| *which < rest.effects.len()) {
            Some(which) => {
                rest.effects.remove(which);
                own.clear();
            }
            None => own.retain(|wave| !one.without.waves().any(|other| other == wave)),
        }
        if one.happened() {
            return self.change_of_stretches(one);
        }
        if one.kind() == burst::KIND {
            let record_s = self.axis.residual.len() as f64 / self.axis.rate_hz;
            let adds = Burst::of(&one.effect.plain()).adds(record_s);
            return Some(100.0 * ((1.0 + adds).max(0.0).sqrt() - 1.0).abs());
        }
        if law.is_none() && own.is_empty() {
            return None;
        }
        let rest = match law {
            Some(_) => of_noise(&rest, self.axis.rate_hz, &self.points),
            None => self.variances.clone(),
        };
        let own = self.added_by(&own);
        self.largest(|place, _| {
            let with = self.variances[place] + self.waves[place];
            let without = rest[place] + self.waves[place] - own[place];
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
        let term = match one.kind().part(&one.effect.plain()) {
            Part::Term(term) => term,
            Part::Distortion(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => return None,
        };
        let curve = allan_curve::allan(&course, rate_hz);
        self.largest(|place, point| {
            let course = curve.iter().find(|one| one.m == point.m);
            let course = course.map_or(0.0, |one| one.variance);
            let own = course + term.passing(point.m, samples as u64, rate_hz);
            // What goes with it adds to none of the others.
            let without = self.variances[place] + (self.waves[place] - course).max(0.0);
            100.0 * ((1.0 + own / without).sqrt() - 1.0)
        })
    }

    /// The largest change at the points.
    fn largest(&self, change: impl Fn(usize, &Point) -> f64) -> Option<f64> {
        let points = self.points.iter().enumerate();
        let changes = points.map(|(place, point)| change(place, point));
        changes.filter(|change| change.is_finite()).reduce(f64::max)
    }
}

/// Variances of a model's noise at some points.
fn of_noise(noise: &ModelAxis, rate_hz: f64, points: &[Point]) -> Vec<f64> {
    let law = noise.law(rate_hz);
    let points = points.par_iter();
    points.map(|point| law.allan_variance(point.m)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::{axis, short};
    use crate::model::PerCoefficient;
    use crate::signal::Unit;

    #[test]
    fn where_an_allan_deviation_is_hardly_known_nothing_changes_it() {
        let axis = axis(1, short(1), |_, noise| noise);
        let noise = ModelAxis {
            name: "X".into(),
            unit: Unit::default(),
            mean: 0.0,
            chain: None,
            coefficients: PerCoefficient::default(),
            effects: Vec::new(),
        };
        let all = allan_curve::allan(axis.residual.whole(), axis.rate_hz);
        let sizes = Sizes::new(&axis, &noise, &Snapshot::of(&[]));
        let known = all.iter().filter(|point| point.edf >= 10.0).count();
        assert!(known < all.len(), "seed 1: all are known");
        // The longest averaging times are known least.
        let longest = sizes.largest(|_, point| point.m as f64);
        let most = all[..known].iter().map(|point| point.m as f64);
        assert_eq!(longest, most.reduce(f64::max), "seed 1");
    }
}
