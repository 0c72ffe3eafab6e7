//! How far the zeros wander while the block is turned: no stretch shows it, since each is short, and
//! over a session it is what makes zeros uncertain.
//!
//! A random walk and the flicker that goes with it, in the proportions of the published sensors
//! ([`PublishedAxis`]), times a factor common to all axes: the misfits of the magnitudes tell that one number, and with
//! nine parameters taken out of a dozen or two not three or six of them.

use nalgebra::{DMatrix, DVector, SVector};

use super::Position;
use crate::model::published::PublishedAxis;

/// Lag at which the logarithm of the flicker begins, seconds: between means over `T` a lag `t` apart it is `ln(t / T) +
/// 1.5` (second difference of `x^2 ln x`), for means over 5 s `ln(t / 1.1 s)`.
const FLICKER_FROM_S: f64 = 1.0;

/// Covariance of the magnitudes, or of the readings, in two parts.
pub(super) struct Drift {
    /// By each stretch's own noise, (m/s^2)^2.
    own: DMatrix<f64>,
    /// By the wander of the published sensors, (m/s^2)^2.
    wander: DMatrix<f64>,
}

impl Drift {
    /// Of positions in which 1 m/s^2 of the readings adds so much to the magnitude.
    pub(super) fn new(positions: &[Position], directions: &[SVector<f64, 3>], end_s: f64) -> Self {
        let number = positions.len();
        let variance = variances(positions);
        let own = DMatrix::from_fn(number, number, |row, column| {
            if row != column {
                return 0.0;
            }
            let squared = directions[row].map(|part| part * part);
            squared.dot(&SVector::from(variance))
        });
        let wander = DMatrix::from_fn(number, number, |row, column| {
            let axes = PublishedAxis::ALL.into_iter().zip(0..);
            let parts = axes.map(|(axis, at)| {
                let common = common(axis, positions[row].time_s, positions[column].time_s, end_s);
                common * directions[row][at] * directions[column][at]
            });
            parts.sum()
        });
        Self { own, wander }
    }

    /// Of the readings of X, Y, Z in each position, one after the other, to which something else adds `besides`,
    /// (m/s^2)^2.
    pub(super) fn of_readings(positions: &[Position], besides: &DMatrix<f64>, end_s: f64) -> Self {
        let number = 3 * positions.len();
        let variance = DVector::from_fn(number, |at, _| variances(positions)[at % 3]);
        let time_s = |at: usize| positions[at / 3].time_s;
        Self {
            own: besides + DMatrix::from_diagonal(&variance),
            wander: DMatrix::from_fn(number, number, |row, column| {
                match PublishedAxis::ALL.get(row % 3) {
                    Some(axis) if row % 3 == column % 3 => {
                        common(*axis, time_s(row), time_s(column), end_s)
                    }
                    _ => 0.0,
                }
            }),
        }
    }

    /// For so many times the wander of the published sensors.
    pub(super) fn covariance(&self, factor: f64) -> DMatrix<f64> {
        &self.own + factor * &self.wander
    }

    /// The stretches' own noise alone.
    pub(super) fn own(&self) -> &DMatrix<f64> {
        &self.own
    }

    /// The factor at which the wander is as large as the stretches' own noise.
    pub(super) fn balance(&self) -> f64 {
        self.own.trace() / self.wander.trace()
    }
}

/// Variances of the means of X, Y, Z: one stretch tells its own badly, all together well.
fn variances(positions: &[Position]) -> [f64; 3] {
    let number = positions.len() as f64;
    [0, 1, 2].map(|axis| positions.iter().map(|one| one.variance[axis]).sum::<f64>() / number)
}

/// Covariance of a published sensor's zeros at two times, both less that at the end, (m/s^2)^2.
fn common(axis: PublishedAxis, one_s: f64, other_s: f64, end_s: f64) -> f64 {
    let apart = |lag_s: f64| squared(axis, lag_s.max(0.0));
    0.5 * (apart(end_s - one_s) + apart(end_s - other_s) - apart((one_s - other_s).abs()))
}

/// Mean square of what a published sensor's zero wanders in so many seconds, (m/s^2)^2: `K^2 t`, and with a spectral
/// density `B^2 / (pi f)` of the flicker `2 B^2 / pi ln(t)`.
fn squared(axis: PublishedAxis, lag_s: f64) -> f64 {
    let of = axis.coefficients();
    let flicker = std::f64::consts::FRAC_2_PI * of.b.powi(2);
    of.k.powi(2) * lag_s + flicker * (lag_s / FLICKER_FROM_S).ln_1p()
}

/// Walk of the published sensors, all axes alike, m/s^2 per root second.
pub(super) fn published_walk() -> f64 {
    let squares = PublishedAxis::ALL.map(|axis| axis.coefficients().k.powi(2));
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}
