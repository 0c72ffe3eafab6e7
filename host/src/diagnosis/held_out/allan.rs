//! A model's Allan deviation compared with that of the held-out half of the record.

use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use crate::bins::point::Point;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::Snapshot;
use crate::diagnosis::held_out::half;
use crate::diagnosis::record::in_record::InRecord;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::views::HeldPoint;
use crate::diagnosis::statistic::allan_curve;
use crate::model::axis::ModelAxis;

/// Degrees of freedom from which a point of the Allan curve says how far a model is off: the
/// deviation is then known to 2.2 %.
const LEAST_EDF: f64 = 1000.0;

/// The measured Allan curve of the held-out half, without the stretches that are masked.
pub struct HeldCurve {
    pub(super) points: Vec<Point>,
    waveforms: Mutex<Vec<Waveform>>,
}

/// What some waveforms add in the held-out half.
struct Waveform {
    waves: Vec<Wave>,
    added: Arc<Added>,
}

/// What waveforms add to Allan variances, by the samples of an average.
#[derive(Debug, Default)]
struct Added(Vec<(u64, f64)>);

impl Added {
    /// To that of averages over `m` samples; below zero where they take away.
    pub fn at(&self, m: u64) -> f64 {
        let found = self.0.iter().find(|(other, _)| *other == m);
        found.map_or(0.0, |(_, variance)| *variance)
    }
}

impl HeldCurve {
    /// The curve of the held-out blocks of an axis.
    pub fn new(axis: &AxisState) -> Self {
        let record = axis.residual.with([]);
        Self {
            points: allan_curve::of_parts(half(&record.values(), 1), axis.rate_hz),
            waveforms: Mutex::default(),
        }
    }

    /// The points of a thousand degrees of freedom or more.
    fn sure(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(|point| point.edf >= LEAST_EDF)
    }

    /// Variances that a model expects at these points: its noise, and the waveforms of a snapshot
    /// where the half has samples.
    pub fn expected(&self, axis: &AxisState, model: &ModelAxis, with: &Snapshot) -> Vec<f64> {
        let law = model.law(axis.rate_hz);
        let sure: Vec<&Point> = self.sure().collect();
        let noise = || -> Vec<f64> {
            let variances = sure.par_iter().map(|point| law.allan_variance(point.m));
            variances.collect()
        };
        let waves: Vec<Wave> = with.waves().cloned().collect();
        let waves = || self.adds(axis, &waves);
        let (noise, waves) = rayon::join(noise, waves);
        let variance = |(point, noise): (&&Point, f64)| (noise + waves.at(point.m)).max(0.0);
        sure.iter().zip(noise).map(variance).collect()
    }

    /// What `waves` add in this half; made once for findings that share them.
    fn adds(&self, axis: &AxisState, waves: &[Wave]) -> Arc<Added> {
        if waves.is_empty() {
            return Arc::default();
        }
        let made = || {
            self.waveforms
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
        };
        let same = |one: &&Waveform| one.waves == waves;
        if let Some(one) = made().iter().find(same) {
            return Arc::clone(&one.added);
        }
        let added = Arc::new(self.adds_once(axis, waves));
        made().push(Waveform {
            waves: waves.to_vec(),
            added: Arc::clone(&added),
        });
        added
    }

    /// The same, where the held-out half has samples that are not excluded.
    fn adds_once(&self, axis: &AxisState, waves: &[Wave]) -> Added {
        let spread = axis.residual.spread();
        let variances = |values: &[f64]| {
            let mut values = values.to_vec();
            for mask in axis.residual.masked_or_cut().chain(spread) {
                values[mask.clone()].fill(f64::NAN);
            }
            let curve = allan_curve::of_parts(half(&values, 1), axis.rate_hz);
            let at = |point: &Point| curve.iter().find(|one| one.m == point.m);
            let variance = |point: &Point| at(point).map_or(0.0, |one| one.variance);
            self.points.iter().map(variance).collect()
        };
        let added = InRecord::of(&axis.residual, waves).adds(variances);
        Added(self.points.iter().map(|point| point.m).zip(added).collect())
    }

    /// Root mean square error of the deviations that belong to the `expected` variances, percent, and
    /// what sampling alone makes of that; `None` where there are no such points.
    pub fn error_percent(&self, expected: &[f64]) -> Option<(f64, f64)> {
        let mut squares = (0.0, 0.0);
        for (point, expected) in self.sure().zip(expected) {
            let error = (expected / point.variance).sqrt() - 1.0;
            squares.0 += error * error;
            squares.1 += 1.0 / (2.0 * point.edf);
        }
        let count = expected.len() as f64;
        (count > 0.0).then(|| {
            (
                100.0 * f64::sqrt(squares.0 / count),
                100.0 * f64::sqrt(squares.1 / count),
            )
        })
    }

    /// The points with what two models expect there.
    pub fn beside(&self, before: &[f64], after: &[f64]) -> Vec<HeldPoint> {
        let expected = before.iter().zip(after);
        let point = |(point, (before, after)): (&Point, (&f64, &f64))| HeldPoint {
            tau_s: point.tau_s,
            m: point.m,
            adev: point.deviation(),
            edf: point.edf,
            before: before.sqrt(),
            after: after.sqrt(),
        };
        self.sure().zip(expected).map(point).collect()
    }
}
