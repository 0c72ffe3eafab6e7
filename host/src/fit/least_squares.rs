//! Linear least squares for a few unknowns, plain and with coefficients that may not be
//! negative.

use nalgebra::{DMatrix, DVector};

/// Minimises `|A x - y|` by Householder QR with column pivoting, after scaling the columns of
/// `A` to unit length. Rows should be in the order of falling size: then each row's error is
/// small against that row, however much the rows differ (A. J. Cox and N. J. Higham 1998).
///
/// Returns `None` where the columns depend on one another or a number is not finite.
pub fn solve(a: &DMatrix<f64>, y: &DVector<f64>) -> Option<DVector<f64>> {
    let lengths: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
    let mut scaled = a.clone();
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    let qr = scaled.col_piv_qr();
    let rhs = qr.q().transpose() * y;
    let mut x = qr.r().solve_upper_triangular(&rhs)?;
    qr.p().inv_permute_rows(&mut x);
    for (value, length) in x.iter_mut().zip(&lengths) {
        *value /= *length;
    }
    x.iter().all(|value| value.is_finite()).then_some(x)
}

/// Minimises `|A x - y|` under `x >= 0`: the best of all choices of columns whose plain
/// solution is not negative. Exact; meant for few columns, as it tries every choice.
///
/// Returns zeros where no choice fits better than nothing.
pub fn solve_non_negative(a: &DMatrix<f64>, y: &DVector<f64>) -> DVector<f64> {
    let columns = a.ncols();
    let mut best = (y.norm_squared(), DVector::zeros(columns));
    for choice in 1_u32..1 << columns {
        let chosen: Vec<usize> = (0..columns).filter(|&j| choice >> j & 1 == 1).collect();
        let part = a.select_columns(&chosen);
        let Some(x) = solve(&part, y) else { continue };
        if x.iter().any(|&value| value < 0.0) {
            continue;
        }
        let misfit = (&part * &x - y).norm_squared();
        if misfit < best.0 {
            let mut all = DVector::zeros(columns);
            chosen
                .iter()
                .zip(x.iter())
                .for_each(|(&j, &value)| all[j] = value);
            best = (misfit, all);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clamps_only_what_must_be() {
        let a = DMatrix::from_row_slice(3, 2, &[1.0, 1.0, 1.0, 2.0, 1.0, 3.0]);
        let rising = DVector::from_row_slice(&[3.0, 5.0, 7.0]);
        assert!(
            (solve_non_negative(&a, &rising) - DVector::from_row_slice(&[1.0, 2.0])).norm() < 1e-12
        );
        let falling = DVector::from_row_slice(&[3.0, 2.0, 1.0]);
        assert!(
            (solve_non_negative(&a, &falling) - DVector::from_row_slice(&[2.0, 0.0])).norm()
                < 1e-12
        );
        assert_eq!(solve_non_negative(&a, &-rising), DVector::zeros(2));
    }

    #[test]
    fn dependent_columns_are_refused() {
        let a = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 2.0, 0.0]);
        assert!(solve(&a, &DVector::from_row_slice(&[1.0, 2.0])).is_none());
    }
}
