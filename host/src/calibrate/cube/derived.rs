//! Twelve parameters as they are told in the cube's frame, and as a board keeps them in that of the sensors, with intervals.
//!
//! The equations are linear in sensitivities, the inverse of what is told. Intervals follow by slopes: over their width,
//! a thousandth at most, the inverse is straight to a thousandth of that.

use nalgebra::{DVector, Matrix3};

use super::super::PARAMETERS;
use super::super::average::Average;
use super::{CUBE_PARAMETERS, sensitivity};

/// Step by which a parameter is changed to see what follows from it: the functions are smooth over some tenths, and
/// rounding leaves the slope ten figures.
const STEP: f64 = 1e-5;

/// What follows from the parameters.
type Derived<const N: usize> = fn(&DVector<f64>) -> Option<[f64; N]>;

/// Values and half 95 % intervals of what follows from the parameters; `None` where nothing does.
pub(super) fn derived<const N: usize>(
    parameters: &DVector<f64>,
    average: &Average,
    of: Derived<N>,
) -> Option<([f64; N], [f64; N])> {
    let mut slopes = vec![DVector::zeros(CUBE_PARAMETERS); N];
    for at in 0..CUBE_PARAMETERS {
        let moved = |step: f64| {
            let mut moved = parameters.clone();
            moved[at] += step;
            of(&moved)
        };
        let (less, more) = (moved(-STEP)?, moved(STEP)?);
        for (slope, (less, more)) in slopes.iter_mut().zip(less.into_iter().zip(more)) {
            slope[at] = (more - less) / (2.0 * STEP);
        }
    }
    let half_widths = std::array::from_fn(|at| average.half_width_along(&slopes[at]));
    Some((of(parameters)?, half_widths))
}

/// `M` row by row, and the zeros.
pub(super) fn in_the_cube(parameters: &DVector<f64>) -> Option<[f64; CUBE_PARAMETERS]> {
    let matrix = sensitivity(parameters).try_inverse()?;
    Some(std::array::from_fn(|at| match at.checked_sub(9) {
        None => matrix[(at / 3, at % 3)],
        Some(axis) => parameters[9 + axis],
    }))
}

/// The lower triangle by which the magnitude is the same, and the zeros: x along the sensitive axis of X, y in the
/// plane of X and Y.
pub(super) fn in_the_sensors(parameters: &DVector<f64>) -> Option<[f64; PARAMETERS]> {
    // What the sensors feel of one another stays whatever the frame: the product of the sensitivities with their
    // transpose, of which the triangle is the root.
    let sensitivity = sensitivity(parameters);
    let lower: Matrix3<f64> = (sensitivity * sensitivity.transpose()).cholesky()?.l();
    let matrix = lower.try_inverse()?;
    let triangle = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];
    Some(std::array::from_fn(|at| match triangle.get(at) {
        Some(place) => matrix[*place],
        None => parameters[at + 3],
    }))
}
