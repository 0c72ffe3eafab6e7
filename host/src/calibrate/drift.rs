//! How far the zeros wander while the block is turned: no stretch shows it, since each is short, and
//! over a session it is what makes zeros uncertain.
//!
//! A random walk, of one strength for all axes, that ends where the session ends. Its strength is what
//! makes the misfits of the magnitudes likeliest (restricted maximum likelihood: Patterson and Thompson,
//! Biometrika 58, 1971), which needs no record besides.

use nalgebra::{DMatrix, SVector};

use super::Position;
use super::weighted::{Linear, Solved};

/// Strengths looked through, (m/s^2)^2 per second: from one that no session shows to one that would be
/// 10 mg after a minute.
const LEAST: f64 = 1e-14;
const MOST: f64 = 1e-4;

/// Halvings of an interval in the logarithm: to a thousandth of the strength.
const STEPS: usize = 24;

/// Covariance of the magnitudes in two parts.
pub(super) struct Drift {
    /// By each stretch's own noise, (m/s^2)^2.
    pub own: DMatrix<f64>,
    /// By a walk of strength one, seconds.
    pub wander: DMatrix<f64>,
}

impl Drift {
    /// Of positions in which 1 m/s^2 of the readings adds so much to the magnitude.
    pub(super) fn new(positions: &[Position], directions: &[SVector<f64, 3>], end_s: f64) -> Self {
        let number = positions.len();
        // One tells its variance badly, all together well.
        let variance = [0, 1, 2].map(|axis| {
            positions.iter().map(|one| one.variance[axis]).sum::<f64>() / number as f64
        });
        let own = DMatrix::from_fn(number, number, |row, column| {
            if row != column {
                return 0.0;
            }
            let squared = directions[row].map(|part| part * part);
            squared.dot(&SVector::from(variance))
        });
        let wander = DMatrix::from_fn(number, number, |row, column| {
            let later_s = positions[row].time_s.max(positions[column].time_s);
            (end_s - later_s).max(0.0) * directions[row].dot(&directions[column])
        });
        Self { own, wander }
    }

    /// Of the magnitudes, for a walk of this strength.
    pub(super) fn covariance(&self, strength: f64) -> DMatrix<f64> {
        &self.own + strength * &self.wander
    }
}

/// The likeliest strength, (m/s^2)^2 per second; 0 where none is likelier than some.
pub(super) fn strength(noise: &Drift, linear: &Linear) -> f64 {
    let loss = |strength: f64| -> f64 {
        let solved = Solved::new(&noise.covariance(strength), &linear.slopes);
        solved.map_or(f64::INFINITY, |solved| {
            let left = (linear.misfits.transpose() * solved.projector() * &linear.misfits)[(0, 0)];
            solved.log_determinant + solved.log_information + left
        })
    };
    // Golden section: one trough, as of a variance it has.
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let [mut low, mut high] = [LEAST, MOST].map(f64::ln);
    for _ in 0..STEPS {
        let step = golden * (high - low);
        if loss((high - step).exp()) <= loss((low + step).exp()) {
            high = low + step;
        } else {
            low = high - step;
        }
    }
    let found = (0.5 * (low + high)).exp();
    if loss(found) < loss(0.0) { found } else { 0.0 }
}
