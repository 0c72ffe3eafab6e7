//! The same five terms, fitted with each point weighed by its own uncertainty and coefficients
//! that may not be negative.
//!
//! The points are those of the *modified* Allan variance, although the table and the plot show the
//! Allan variance: where quantisation noise is large, the Allan variance is ruled by it at every
//! averaging time below the crossing with the walk, since its kernel does not keep out high
//! frequencies, and white noise only shows as a small difference of large numbers. The modified
//! variance of quantisation noise falls faster by a factor of `m`, so that each term has
//! averaging times of its own, and its estimates lose nothing by being taken in strides.
//!
//! Real records often hold more than five terms. Where the curve departs from the model by far
//! more than its own uncertainty, every point is allowed an error of its own, the same fraction of
//! the model everywhere and just as large as the misfit asks for. Without it the points at short
//! averaging times, good to a tenth of a percent, would bend the model for the sake of a detail
//! that it does not describe.
//!
//! A point's weight is the inverse variance of its estimate under the fitted model, found by
//! iteration: the measured curve gives the first weights, then the model's own, so that a
//! point that came out low by chance does not gain weight by it. The intervals take into account
//! that the points err together ([`super::covariance`]).

use nalgebra::{DMatrix, DVector};

use super::covariance::Kernels;
use super::design::Design;
use super::least_squares::solve_non_negative;
use super::result::WeightedValue;
use crate::bins::point::Point;
use crate::model::kernel::Kernel;
use crate::model::{Coefficient, PerCoefficient};
use crate::numeric::bisect::bisect;

/// Rounds of weighing at most.
const ROUNDS: usize = 8;

/// The rounds end when none moves the curve by more than this, in standard deviations of a point.
const SETTLED: f64 = 1e-3;

/// Mean squared residual, in standard deviations, from which the model needs an allowance. It is
/// 1 on average for data that follow the model, with a scatter of 0.3 as neighbours err together.
const MISFIT: f64 = 2.5;

/// Points with fewer degrees of freedom carry no weight worth having and spoil its estimate.
const LEAST_EDF: f64 = 1.0;

/// Standard deviations of a 95 % interval, as its readers know them.
const SIGMAS: f64 = 1.96;

/// The result of the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedFit {
    /// The coefficients.
    pub coefficients: PerCoefficient<WeightedValue>,
    /// Error of the model that had to be allowed for at every point, as a fraction of its
    /// variance; zero where the record follows the model.
    pub allowance: f64,
}

/// Fits the points of a modified Allan curve at `rate_hz`.
///
/// `None` where fewer than five points carry weight, or the curve is zero everywhere.
pub fn fit(points: &[Point], rate_hz: f64, design: &Design) -> Option<WeightedFit> {
    let count = |point: &&Point| point.edf >= LEAST_EDF && point.variance > 0.0;
    let points: Vec<Point> = points.iter().filter(count).copied().collect();
    if points.len() < Coefficient::ALL.len() {
        return None;
    }
    let factors: Vec<u64> = points.iter().map(|point| point.m).collect();
    let a = design.matrix(Kernel::Modified, &factors);
    let y = DVector::from_iterator(points.len(), points.iter().map(|point| point.variance));
    let mut deviation = DVector::from_iterator(
        points.len(),
        points
            .iter()
            .map(|point| point.variance * (2.0 / point.edf).sqrt()),
    );
    let kernels = Kernels::new(&points, rate_hz);
    let mut squares = weigh_and_solve(&a, &y, &deviation);
    let mut errors = DMatrix::zeros(0, 0);
    let mut allowance = 0.0;
    for _ in 0..ROUNDS {
        let (model, expected) = (per_coefficient(&squares), &a * &squares);
        errors = kernels.covariance(|f| design.spectrum(&model, f), &expected);
        allowance = needed_allowance(&(&y - &expected), &errors.diagonal(), &expected);
        for (i, one) in expected.iter().enumerate() {
            errors[(i, i)] += (allowance * one).powi(2);
        }
        deviation = errors.diagonal().map(f64::sqrt);
        if !deviation.iter().all(|one| one.is_normal()) {
            return None;
        }
        squares = weigh_and_solve(&a, &y, &deviation);
        let moved = (&a * &squares - &expected).component_div(&deviation);
        if moved.amax() < SETTLED {
            break;
        }
    }
    let found: Vec<usize> = (0..squares.len()).filter(|&j| squares[j] > 0.0).collect();
    let values = Coefficient::ALL.iter().enumerate().map(|(j, _)| {
        let mut columns = found.clone();
        if !columns.contains(&j) {
            columns.push(j);
        }
        let error = SIGMAS * standard_error(&a, &deviation, &errors, &columns, j);
        WeightedValue {
            value: (squares[j] > 0.0).then(|| squares[j].sqrt()),
            squared: squares[j],
            lo: (squares[j] - error).max(0.0).sqrt(),
            hi: (squares[j] + error).sqrt(),
        }
    });
    let mut values = values.collect::<Vec<_>>().into_iter();
    let mut next = || values.next().filter(|value| value.hi.is_finite());
    let [r, k, b, n, q] = [next()?, next()?, next()?, next()?, next()?];
    Some(WeightedFit {
        coefficients: PerCoefficient { r, k, b, n, q },
        allowance,
    })
}

/// The fraction of `expected` that, as an independent error of every point, brings the mean
/// squared residual down to what five fitted coefficients leave; zero where chance explains it.
fn needed_allowance(
    residuals: &DVector<f64>,
    variances: &DVector<f64>,
    expected: &DVector<f64>,
) -> f64 {
    let free = residuals
        .len()
        .saturating_sub(Coefficient::ALL.len())
        .max(1) as f64;
    let misfit = |allowance: f64| {
        let rows = residuals.iter().zip(variances).zip(expected);
        let squares = rows.map(|((residual, variance), expected)| {
            residual * residual / (variance + (allowance * expected).powi(2))
        });
        squares.sum::<f64>() / free
    };
    if misfit(0.0) < MISFIT {
        return 0.0;
    }
    // Monotonous; a model that is off by more than tenfold everywhere is beyond help.
    bisect(0.0, 10.0, 50, |allowance| misfit(allowance) > 1.0)
}

fn per_coefficient(squares: &DVector<f64>) -> PerCoefficient<f64> {
    let mut squares = squares.iter();
    PerCoefficient::from_fn(|_| *squares.next().unwrap_or(&0.0))
}

fn weigh_and_solve(a: &DMatrix<f64>, y: &DVector<f64>, deviation: &DVector<f64>) -> DVector<f64> {
    let weighted = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] / deviation[i]);
    solve_non_negative(&weighted, &y.component_div(deviation))
}

/// Standard error of the square in column `j`, of a fit with the columns `columns` weighted by
/// `deviation` to points with the covariance `errors`. Infinite if the points do not distinguish them.
fn standard_error(
    a: &DMatrix<f64>,
    deviation: &DVector<f64>,
    errors: &DMatrix<f64>,
    columns: &[usize],
    j: usize,
) -> f64 {
    // Columns scaled to one, so that their units do not matter.
    let part = a.select_columns(columns);
    let weighted = DMatrix::from_fn(part.nrows(), part.ncols(), |i, k| {
        part[(i, k)] / deviation[i]
    });
    let lengths = DVector::from_iterator(columns.len(), weighted.column_iter().map(|c| c.norm()));
    let scaled = DMatrix::from_fn(part.nrows(), part.ncols(), |i, k| {
        weighted[(i, k)] / lengths[k]
    });
    let Some(normal) = (scaled.transpose() * &scaled).try_inverse() else {
        return f64::INFINITY;
    };
    let correlation = DMatrix::from_fn(part.nrows(), part.nrows(), |i, k| {
        errors[(i, k)] / deviation[i] / deviation[k]
    });
    let middle = scaled.transpose() * correlation * &scaled;
    let result = &normal * middle * &normal;
    let Some(at) = columns.iter().position(|&column| column == j) else {
        return f64::INFINITY;
    };
    result[(at, at)].sqrt() / lengths[at]
}
