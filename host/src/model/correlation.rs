//! How the random numbers of some axes are mixed, so that they are correlated.

use nalgebra::DMatrix;

/// How the random numbers of `n` axes are mixed: the lower Cholesky factor of their `correlation`,
/// one row an axis; the unit matrix where there is none.
///
/// # Errors
/// In words, if the correlation is none.
pub(super) fn mixing(correlation: Option<&[Vec<f64>]>, n: usize) -> Result<DMatrix<f64>, String> {
    let Some(rows) = correlation else {
        return Ok(DMatrix::identity(n, n));
    };
    if rows.len() != n || rows.iter().any(|row| row.len() != n) {
        return Err(format!(
            "correlation is no matrix of {n} by {n}, one row an axis"
        ));
    }
    let matrix = DMatrix::from_fn(n, n, |i, j| rows[i][j]);
    let bounded = matrix.iter().all(|one| one.abs() <= 1.0);
    let unit = matrix.diagonal().iter().all(|&one| one == 1.0);
    if !bounded || !unit || matrix != matrix.transpose() {
        return Err(
            "correlation is not symmetric with 1 on the diagonal and -1 to 1 elsewhere".to_owned(),
        );
    }
    semidefinite_factor(&matrix).ok_or_else(|| {
        "correlation has a negative eigenvalue: no three signals are correlated so".to_owned()
    })
}

/// The lower factor `L` of `matrix = L L'`; a pivot of zero is admitted.
fn semidefinite_factor(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    const ROUNDING: f64 = 1e-12;
    let n = matrix.nrows();
    let mut factor = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            let rest: f64 =
                matrix[(i, j)] - (0..j).map(|k| factor[(i, k)] * factor[(j, k)]).sum::<f64>();
            factor[(i, j)] = if i == j {
                if rest < -ROUNDING {
                    return None;
                }
                rest.max(0.0).sqrt()
            } else if factor[(j, j)] > 0.0 {
                rest / factor[(j, j)]
            } else if rest.abs() > ROUNDING {
                return None;
            } else {
                0.0
            };
        }
    }
    Some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_correlations_are_refused() {
        let three = |r12: f64, r13: f64, r23: f64| {
            let rows = [[1.0, r12, r13], [r12, 1.0, r23], [r13, r23, 1.0]];
            mixing(Some(&rows.map(Vec::from)), 3)
        };
        assert!(three(0.9, 0.9, -0.9).is_err());
        // Two axes that are one and the same are possible.
        let factor = three(1.0, 0.5, 0.5).expect("a correlation");
        let product = &factor * factor.transpose();
        assert!((product[(2, 1)] - 0.5).abs() < 1e-15 && (product[(2, 2)] - 1.0).abs() < 1e-15);
    }
}
