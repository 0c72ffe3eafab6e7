//! How the error of the integrated signal grows: predicted before and after, and observed.
//!
//! A window of the record is a small voyage: its first part is an alignment whose mean is taken for
//! the bias, the rest is integrated. Windows lie within every other block, those that the error of
//! the Allan deviation is measured on; the coefficients are those of the whole record. What the
//! deterministic part of the extended model does in the same windows is added to the prediction in
//! squares.

use rayon::prelude::*;

use crate::bins::point;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::held_out::BLOCKS;
use crate::diagnosis::record::in_record::InRecord;
use crate::diagnosis::result::views::VelocityError;
use crate::diagnosis::views::Models;
use crate::model::PerCoefficient;
use crate::model::axis::ModelAxis;
use crate::navigate::{self, ALIGNMENT_S, Integration, response::Integral};

/// Times of integration, seconds; those that fit into a block: choices, decades and minutes.
const TIMES_S: [f64; 6] = [0.1, 1.0, 10.0, 60.0, 300.0, 600.0];

/// Part of a block that the alignment takes at most: a choice. The rest is integrated.
const ALIGNED: f64 = 0.25;

/// Windows begin at this part of their length, one over it: overlapped by three quarters they use
/// all of a block.
const STEP: usize = 4;

/// Windows that do not overlap, at least, for an observation: the root of their mean square is then
/// known to 35 %.
const LEAST: usize = 4;

/// Observed and predicted errors of an axis; none for times that leave too few windows.
pub(crate) fn compare(axis: &AxisState, models: Models<'_>, own: &InRecord) -> Vec<VelocityError> {
    let rate_hz = axis.rate_hz;
    let block = axis.residual.len().div_ceil(BLOCKS).max(1);
    let alignment_s = ALIGNMENT_S.min(ALIGNED * block as f64 / rate_hz);
    let windows = TIMES_S.map(|t_s| Window {
        aligned: (alignment_s * rate_hz).round() as usize,
        integrated: (t_s * rate_hz).round() as usize,
        rate_hz,
    });
    let observed = mean_squares(&windows, axis.residual.whole(), block);
    let added = own.adds(|values| {
        let squares = mean_squares(&windows, values, block).into_iter();
        squares
            .map(|one| one.map_or(0.0, |(square, _)| square))
            .collect()
    });
    // Of what cannot be observed nothing is predicted either: a window of minutes in a record of
    // milliseconds would take longer than all else.
    let seen: Vec<&Window> = windows
        .iter()
        .zip(&observed)
        .filter(|(_, one)| one.is_some())
        .map(|(window, _)| window)
        .collect();
    let (before, after) = rayon::join(
        || predict(models.base, &seen),
        || predict(models.noise, &seen),
    );
    let mut predicted = before.into_iter().zip(after);
    let compared = |(number, observed): (usize, Option<(f64, usize)>)| {
        let (square, disjoint) = observed?;
        let (lo, hi) = point::interval(square, disjoint as f64);
        let (before, after) = predicted.next()?;
        let added = added.get(number).copied().unwrap_or(0.0);
        Some(VelocityError {
            t_s: TIMES_S[number],
            alignment_s,
            observed: square.sqrt(),
            lo,
            hi,
            before,
            after: (after * after + added).max(0.0).sqrt(),
        })
    };
    observed
        .into_iter()
        .enumerate()
        .filter_map(compared)
        .collect()
}

/// One standard deviation of the error under a model for each of `windows`, which are aligned alike; the
/// intervals of its coefficients left out.
fn predict(model: &ModelAxis, windows: &[&Window]) -> Vec<f64> {
    let known = PerCoefficient::from_fn(|one| {
        let value = model.coefficients.get(one).abs();
        (value, value)
    });
    let Some(first) = windows.first() else {
        return Vec::new();
    };
    let rate_hz = first.rate_hz;
    let times_s = windows
        .iter()
        .map(|window| window.integrated as f64 / rate_hz);
    let times_s: Vec<f64> = times_s.collect();
    let integration = Integration {
        integral: Integral::Velocity,
        rate_hz,
        alignment_s: first.aligned as f64 / rate_hz,
    };
    let growth = navigate::growth(model, &known, integration, &times_s);
    growth.into_iter().map(|one| one.sigma).collect()
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

    /// What its windows in a block see.
    fn seen(&self, block: &Sums) -> Seen {
        let mut seen = Seen::default();
        let Some(last) = block.len().checked_sub(self.len()) else {
            return seen;
        };
        if self.aligned == 0 {
            return seen;
        }
        let mut free = 0;
        for start in (0..=last).step_by((self.len() / STEP).max(1)) {
            let (middle, end) = (start + self.aligned, start + self.len());
            if block.missing[start] != block.missing[end] {
                continue;
            }
            let bias = block.between(start, middle) / self.aligned as f64;
            let change = block.between(middle, end) - bias * self.integrated as f64;
            seen.squares += (change / self.rate_hz).powi(2);
            seen.count += 1;
            if start >= free {
                seen.disjoint += 1;
                free = end;
            }
        }
        seen
    }
}

/// Errors that windows end with.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    /// Sum of the squares of the errors.
    squares: f64,
    /// Windows without a missing sample.
    count: usize,
    /// Those of them that do not overlap.
    disjoint: usize,
}

/// Sums of a block from its start.
struct Sums {
    /// Sums of the samples that are there, up to each.
    sums: Vec<f64>,
    /// Samples that are missing, up to each.
    missing: Vec<u32>,
}

impl Sums {
    fn new(values: &[f64]) -> Self {
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
        Self { sums, missing }
    }

    /// How many samples the window spans, missing ones included.
    fn len(&self) -> usize {
        self.sums.len() - 1
    }

    fn between(&self, from: usize, to: usize) -> f64 {
        self.sums[to] - self.sums[from]
    }
}

/// For each of `windows` the mean square of the error over all of them without a missing sample in every
/// other block of `block` samples, and how many of these do not overlap; `None` for too few.
fn mean_squares(windows: &[Window], values: &[f64], block: usize) -> Vec<Option<(f64, usize)>> {
    let parts: Vec<&[f64]> = values.chunks(block).skip(1).step_by(2).collect();
    let seen: Vec<Vec<Seen>> = parts
        .into_par_iter()
        .map(|part| {
            let sums = Sums::new(part);
            windows.iter().map(|window| window.seen(&sums)).collect()
        })
        .collect();
    let over = |number: usize| {
        let all = seen.iter().map(|block| block[number]);
        let sum = all.fold(Seen::default(), |sum, one| Seen {
            squares: sum.squares + one.squares,
            count: sum.count + one.count,
            disjoint: sum.disjoint + one.disjoint,
        });
        (sum.disjoint >= LEAST).then(|| (sum.squares / sum.count as f64, sum.disjoint))
    };
    (0..windows.len()).map(over).collect()
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
        let (square, disjoint) = mean_squares(&[window], &ramp, 2000)[0].expect("windows");
        // R t (t + c) / 2, docs/explanation/noise-model.md.
        let expected = slope * 30.0 * (30.0 + 10.0) / 2.0;
        assert!((square.sqrt() / expected - 1.0).abs() < 1e-9, "{square}");
        assert_eq!(disjoint, 8 * 5);
    }

    /// A window of minutes in a record of milliseconds would take longer to predict than all else.
    #[test]
    fn nothing_is_predicted_that_cannot_be_observed() {
        let axis = crate::diagnosis::trial::axis(1, 9000, |_, noise| noise);
        let model = crate::model::whole::Model::published(None).axes.remove(0);
        let models = Models {
            base: &model,
            noise: &model,
            whole: &model,
        };
        let own = InRecord::of(&axis.residual, &[]);
        let times: Vec<f64> = compare(&axis, models, &own)
            .iter()
            .map(|one| one.t_s)
            .collect();
        // A block is 563 samples at 1000/s, and some windows have to fit in: one tenth of a second.
        assert_eq!(times, [0.1]);
        assert!(predict(&model, &[]).is_empty());
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
        let (_, disjoint) = mean_squares(&[window], &values, 100)[0].expect("windows");
        assert_eq!(disjoint, 7 * 5);
    }
}
