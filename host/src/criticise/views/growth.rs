//! How the error of the integrated signal grows: predicted before and after, and observed.
//!
//! A window of the record is a small voyage: its first part is an alignment whose mean is taken for
//! the bias, the rest is integrated. Windows lie within every other block, those that the error of
//! the Allan deviation is measured on; the coefficients are those of the whole record. What the
//! deterministic part of the extended model does in the same windows is added to the prediction in
//! squares.

use serde::Serialize;

use super::super::axis::AxisState;
use super::super::gain::BLOCKS;
use super::Models;
use crate::bins::point;
use crate::model::PerCoefficient;
use crate::model::whole::ModelAxis;
use crate::navigate::{self, ALIGNMENT_S, response::Integral};

/// Times of integration, seconds; those that fit into a block.
const TIMES_S: [f64; 6] = [0.1, 1.0, 10.0, 60.0, 300.0, 600.0];

/// Part of a block that the alignment takes at most.
const ALIGNED: f64 = 0.25;

/// Windows begin this part of their length apart.
const STEP: usize = 4;

/// Windows that do not overlap, at least, for an observation.
const LEAST: usize = 4;

/// Error of the integral after some time; unit of the signal times seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VelocityError {
    /// Time of integration, seconds.
    pub t_s: f64,
    /// Length of the alignment before it, seconds.
    pub alignment_s: f64,
    /// Root mean square over the windows.
    pub observed: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// What the five terms alone predict, one standard deviation.
    pub before: f64,
    /// What the extended model predicts.
    pub after: f64,
}

/// Observed and predicted errors of an axis; none for times that leave too few windows.
pub(super) fn compare(axis: &AxisState, models: Models<'_>, wave: &[f64]) -> Vec<VelocityError> {
    let rate_hz = axis.rate_hz;
    let block = axis.mended.len().div_ceil(BLOCKS).max(1);
    let alignment_s = ALIGNMENT_S.min(ALIGNED * block as f64 / rate_hz);
    let mut found = Vec::new();
    for t_s in TIMES_S {
        let window = Window {
            aligned: (alignment_s * rate_hz).round() as usize,
            integrated: (t_s * rate_hz).round() as usize,
            rate_hz,
        };
        let Some((square, disjoint)) = window.mean_square(axis.mended.measured(), block) else {
            continue;
        };
        let (lo, hi) = point::interval(square, disjoint as f64);
        let of_wave = window.mean_square(wave, block).map_or(0.0, |found| found.0);
        found.push(VelocityError {
            t_s,
            alignment_s,
            observed: square.sqrt(),
            lo,
            hi,
            before: predict(models.base, &window),
            after: predict(models.noise, &window).hypot(of_wave.sqrt()),
        });
    }
    found
}

/// One standard deviation of the error under a model, the intervals of its coefficients left out.
fn predict(model: &ModelAxis, window: &Window) -> f64 {
    let known = PerCoefficient::from_fn(|one| {
        let value = model.coefficients.get(one).abs();
        (value, value)
    });
    let (alignment_s, t_s) = (
        window.aligned as f64 / window.rate_hz,
        window.integrated as f64 / window.rate_hz,
    );
    let growth = navigate::growth(
        model,
        &known,
        Integral::Velocity,
        window.rate_hz,
        alignment_s,
        &[t_s],
    );
    growth.first().map_or(f64::NAN, |one| one.sigma)
}

/// An alignment and an integration, samples.
struct Window {
    aligned: usize,
    integrated: usize,
    rate_hz: f64,
}

impl Window {
    const fn len(&self) -> usize {
        self.aligned + self.integrated
    }

    /// Mean square of the error over all windows without a missing sample in every other block of
    /// `block` samples, and how many of them do not overlap.
    fn mean_square(&self, values: &[f64], block: usize) -> Option<(f64, usize)> {
        let (mut sum, mut count, mut disjoint) = (0.0, 0.0, 0);
        let step = (self.len() / STEP).max(1);
        for part in values.chunks(block).skip(1).step_by(2) {
            let mut free = 0;
            for (start, error) in self.errors(part, step) {
                sum += error * error;
                count += 1.0;
                if start >= free {
                    disjoint += 1;
                    free = start + self.len();
                }
            }
        }
        (disjoint >= LEAST).then(|| (sum / count, disjoint))
    }

    /// Begin of each window and the error that it ends with.
    fn errors(&self, values: &[f64], step: usize) -> Vec<(usize, f64)> {
        if self.len() > values.len() || self.aligned == 0 {
            return Vec::new();
        }
        // Sums from the start, over what is there, and how many are not.
        let (mut sums, mut missing) = (vec![0.0], vec![0_u32]);
        let (mut sum, mut bad) = (0.0, 0);
        for &value in values {
            if value.is_finite() {
                sum += value;
            } else {
                bad += 1;
            }
            sums.push(sum);
            missing.push(bad);
        }
        (0..=values.len() - self.len())
            .step_by(step)
            .filter(|&start| missing[start] == missing[start + self.len()])
            .map(|start| {
                let (middle, end) = (start + self.aligned, start + self.len());
                let bias = (sums[middle] - sums[start]) / self.aligned as f64;
                let change = sums[end] - sums[middle] - bias * self.integrated as f64;
                (start, change / self.rate_hz)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_errs_as_it_should() {
        let window = Window {
            aligned: 100,
            integrated: 300,
            rate_hz: 10.0,
        };
        let slope = 0.02;
        let ramp: Vec<f64> = (0..32_000).map(|n| slope * f64::from(n) / 10.0).collect();
        let (square, disjoint) = window.mean_square(&ramp, 2000).expect("windows");
        // R t (t + c) / 2, docs/model.md.
        let expected = slope * 30.0 * (30.0 + 10.0) / 2.0;
        assert!((square.sqrt() / expected - 1.0).abs() < 1e-9, "{square}");
        assert_eq!(disjoint, 8 * 5);
    }

    #[test]
    fn windows_with_missing_samples_do_not_count() {
        let window = Window {
            aligned: 10,
            integrated: 10,
            rate_hz: 1.0,
        };
        let mut values = vec![0.0; 1600];
        values[100..200]
            .iter_mut()
            .step_by(15)
            .for_each(|value| *value = f64::NAN);
        let (_, disjoint) = window.mean_square(&values, 100).expect("windows");
        assert_eq!(disjoint, 7 * 5);
    }
}
