//! How well the bins determine the squares, and how these scatter.
//!
//! With `a_ib = E_ib / E_b` the score of the likelihood is `sum_b dof_b/2 a_ib (y_b / E_b - 1)`. If
//! bins were independent its variance would be the Fisher information `I`; with the relative
//! covariance `C` of the bins it is `J`, and the squares have the covariance `I^-1 J I^-1`
//! (Godambe 1960).

use nalgebra::{DMatrix, SVD};

use super::data::Data;

/// Fisher information of the squares of `components` at the expectation `expected`.
pub fn fisher(data: &Data, components: &[Vec<f64>], expected: &[f64]) -> DMatrix<f64> {
    let share = shares(components, expected);
    let size = components.len();
    DMatrix::from_fn(size, size, |i, j| {
        let bins = share[i].iter().zip(&share[j]).zip(&data.dof);
        bins.map(|((a, b), dof)| 0.5 * dof * a * b).sum()
    })
}

/// Covariance of the squares at the expectation `expected`, as if none were at its bound; zero for
/// components that show in no bin.
pub fn covariance(data: &Data, components: &[Vec<f64>], expected: &[f64]) -> DMatrix<f64> {
    let information = fisher(data, components, expected);
    let inverse = inverse(&information);
    let share = shares(components, expected);
    let weighted = DMatrix::from_fn(data.len(), components.len(), |b, i| {
        0.5 * data.dof[b] * share[i][b]
    });
    let scatter = weighted.transpose() * (&data.covariance * &weighted);
    &inverse * scatter * &inverse
}

/// Correlation matrix of a covariance; zero in the row and column of a variance of zero.
pub fn correlation(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let deviation = covariance.diagonal().map(f64::sqrt);
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        let both = deviation[i] * deviation[j];
        if both > 0.0 {
            covariance[(i, j)] / both
        } else {
            0.0
        }
    })
}

/// Inverse of an information matrix whose entries may differ by any power of ten; rows without
/// information stay zero.
pub fn inverse(information: &DMatrix<f64>) -> DMatrix<f64> {
    let size = information.nrows();
    let unit = information
        .diagonal()
        .map(|one| if one > 0.0 { 1.0 / one.sqrt() } else { 0.0 });
    let scaled = DMatrix::from_fn(size, size, |i, j| {
        // Without information: a row of the unit matrix, put to zero below.
        let empty = i == j && unit[i] == 0.0;
        information[(i, j)] * unit[i] * unit[j] + if empty { 1.0 } else { 0.0 }
    });
    let inverse = scaled
        .clone()
        .cholesky()
        .map(|factor| factor.inverse())
        .or_else(|| pseudo_inverse(scaled))
        .unwrap_or_else(|| DMatrix::zeros(size, size));
    DMatrix::from_fn(size, size, |i, j| inverse[(i, j)] * unit[i] * unit[j])
}

/// Rotations that a decomposition of a handful of rows takes: some tens. Without a bound it never ends
/// where a number is none.
const ROTATIONS: usize = 10_000;

/// Of a matrix that is not positive definite; `None` where it holds what is no number.
fn pseudo_inverse(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    if !matrix.iter().all(|one| one.is_finite()) {
        return None;
    }
    let parts = SVD::try_new(matrix, true, true, f64::EPSILON, ROTATIONS)?;
    parts.pseudo_inverse(1e-14).ok()
}

/// `E_ib / E_b`.
fn shares(components: &[Vec<f64>], expected: &[f64]) -> Vec<Vec<f64>> {
    components
        .iter()
        .map(|component| component.iter().zip(expected).map(|(u, e)| u / e).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A decomposition of what is no number would turn for ever.
    #[test]
    fn what_is_no_number_has_no_inverse_and_ends() {
        for bad in [f64::NAN, f64::INFINITY] {
            let information = DMatrix::from_row_slice(2, 2, &[1.0, bad, bad, 1.0]);
            assert_eq!(inverse(&information), DMatrix::zeros(2, 2), "{bad}");
        }
        let twins = DMatrix::from_element(2, 2, 4.0);
        // Of two that cannot be told apart each gets half: the pseudo-inverse.
        let shared = DMatrix::from_element(2, 2, 1.0 / 16.0);
        assert!((inverse(&twins) - shared).amax() < 1e-12);
    }
}
