//! Magnitudes at some parameters, how they change with these, and weighted least squares.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SMatrix, SVector};

use super::{PARAMETERS, Position};

/// Magnitudes and what they depend on, at some parameters.
pub(super) struct Linear {
    /// Misfits: gravity less magnitude, m/s^2.
    pub misfits: DVector<f64>,
    /// By position and parameter.
    pub slopes: DMatrix<f64>,
    /// What 1 m/s^2 of each reading adds to the magnitude, by position.
    pub directions: Vec<SVector<f64, 3>>,
}

/// Readings as parameters make them, their magnitudes and slopes.
pub(super) fn linear(
    positions: &[Position],
    values: &SVector<f64, PARAMETERS>,
    gravity_m_s2: f64,
) -> Linear {
    let matrix = matrix(values);
    let zero = SVector::<f64, 3>::new(values[6], values[7], values[8]);
    let mut misfits = DVector::zeros(positions.len());
    let mut slopes = DMatrix::zeros(positions.len(), PARAMETERS);
    let mut directions = Vec::with_capacity(positions.len());
    for (at, position) in positions.iter().enumerate() {
        let reading = SVector::from(position.mean_m_s2) - zero;
        let acceleration = matrix * reading;
        let magnitude = acceleration.norm();
        let unit = acceleration / magnitude.max(f64::MIN_POSITIVE);
        misfits[at] = gravity_m_s2 - magnitude;
        for (column, (row, of)) in [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)]
            .into_iter()
            .enumerate()
        {
            slopes[(at, column)] = unit[row] * reading[of];
        }
        let direction = matrix.transpose() * unit;
        for axis in 0..3 {
            slopes[(at, 6 + axis)] = -direction[axis];
        }
        directions.push(direction);
    }
    Linear {
        misfits,
        slopes,
        directions,
    }
}

/// The matrix of the first six parameters.
fn matrix(values: &SVector<f64, PARAMETERS>) -> SMatrix<f64, 3, 3> {
    SMatrix::<f64, 3, 3>::new(
        values[0], 0.0, 0.0, values[1], values[2], 0.0, values[3], values[4], values[5],
    )
}

/// A weighted least-squares problem, solved.
pub(super) struct Solved {
    inverse: DMatrix<f64>,
    log_determinant: f64,
    /// Of the parameters.
    pub covariance: DMatrix<f64>,
    log_information: f64,
    /// Slopes times the inverse.
    weighted: DMatrix<f64>,
}

impl Solved {
    /// `None` where a matrix is not positive definite.
    pub(super) fn new(covariance: &DMatrix<f64>, slopes: &DMatrix<f64>) -> Option<Self> {
        let whole = Cholesky::new(covariance.clone())?;
        let inverse = whole.inverse();
        let weighted = slopes.transpose() * &inverse;
        let information = Cholesky::new(&weighted * slopes)?;
        Some(Self {
            inverse,
            log_determinant: log_determinant(&whole),
            covariance: information.inverse(),
            log_information: log_determinant(&information),
            weighted,
        })
    }

    /// Change of the parameters that these misfits ask for.
    pub(super) fn step(&self, misfits: &DVector<f64>) -> DVector<f64> {
        &self.covariance * (&self.weighted * misfits)
    }

    /// What takes the fitted part out of misfits and weights the rest.
    pub(super) fn projector(&self) -> DMatrix<f64> {
        &self.inverse - self.weighted.transpose() * &self.covariance * &self.weighted
    }

    /// Restricted likelihood of the misfits by this covariance, in the logarithm, but for a constant.
    pub(super) fn log_likelihood(&self, misfits: &DVector<f64>) -> f64 {
        let weighted = &self.weighted * misfits;
        let explained = weighted.dot(&(&self.covariance * &weighted));
        let left = misfits.dot(&(&self.inverse * misfits)) - explained;
        -0.5 * (self.log_determinant + self.log_information + left)
    }
}

fn log_determinant(whole: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * whole.l_dirty().diagonal().map(f64::ln).sum()
}
