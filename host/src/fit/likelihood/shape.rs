//! Parameters that the spectrum is not linear in: corners, widths, time constants.
//!
//! For every choice of them the squared coefficients follow by [`super::maximise`], which takes
//! about a millisecond; what is left is a search in one to a few dimensions, by the simplex of J. A.
//! Nelder and R. Mead (Comput. J. 7, 1965). Parameters are best given as logarithms.

use super::data::Data;
use super::scoring::{Fit, maximise};

/// Most evaluations per dimension.
const EVALUATIONS: usize = 150;

/// Difference in log-likelihood over the simplex at which the search has arrived.
const ARRIVED: f64 = 1e-6;

/// The best fit over shapes.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeFit {
    /// The shape parameters.
    pub shape: Vec<f64>,
    /// The components' squares at this shape.
    pub fit: Fit,
}

/// Finds the shape, and the squares of its components, at which the likelihood is greatest near
/// `start`. The first simplex has edges of `step`, one a parameter. `components` gives the
/// expectations of all bins for unit squares; `None` from it means out of range.
///
/// `None` where `start` itself is out of range.
pub fn maximise_shape(
    data: &Data,
    start: &[f64],
    step: &[f64],
    mut components: impl FnMut(&[f64]) -> Option<Vec<Vec<f64>>>,
) -> Option<ShapeFit> {
    let mut at = |shape: &[f64]| -> Option<Fit> { maximise(data, &components(shape)?) };
    let value = |fit: &Option<Fit>| {
        fit.as_ref()
            .map_or(f64::INFINITY, |fit| -fit.log_likelihood)
    };
    at(start)?;
    let size = start.len();
    let mut simplex: Vec<(Vec<f64>, Option<Fit>)> = (0..=size)
        .map(|vertex| {
            let mut shape = start.to_vec();
            if vertex > 0 {
                shape[vertex - 1] += step[vertex - 1];
            }
            let fit = at(&shape);
            (shape, fit)
        })
        .collect();
    for _ in 0..EVALUATIONS * size {
        simplex.sort_by(|one, other| value(&one.1).total_cmp(&value(&other.1)));
        let (best, worst) = (value(&simplex[0].1), value(&simplex[size].1));
        if worst - best < ARRIVED {
            break;
        }
        let centre: Vec<f64> = (0..size)
            .map(|d| simplex[..size].iter().map(|v| v.0[d]).sum::<f64>() / size as f64)
            .collect();
        let mut towards = |share: f64| {
            let shape: Vec<f64> = (0..size)
                .map(|d| centre[d] + share * (simplex[size].0[d] - centre[d]))
                .collect();
            let fit = at(&shape);
            (shape, fit)
        };
        let reflected = towards(-1.0);
        let candidate = if value(&reflected.1) < best {
            let expanded = towards(-2.0);
            if value(&expanded.1) < value(&reflected.1) {
                expanded
            } else {
                reflected
            }
        } else if value(&reflected.1) < value(&simplex[size - 1].1) {
            reflected
        } else if value(&reflected.1) < worst {
            towards(-0.5)
        } else {
            towards(0.5)
        };
        if value(&candidate.1) < worst {
            simplex[size] = candidate;
            continue;
        }
        let first = simplex[0].0.clone();
        for (shape, fit) in &mut simplex[1..] {
            shape
                .iter_mut()
                .zip(&first)
                .for_each(|(one, first)| *one = 0.5 * (*one + first));
            *fit = at(shape);
        }
    }
    simplex.sort_by(|one, other| value(&one.1).total_cmp(&value(&other.1)));
    let (shape, fit) = simplex.swap_remove(0);
    Some(ShapeFit { shape, fit: fit? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn finds_a_corner_beside_a_floor() {
        let f_hz: Vec<f64> = (0..160).map(|k| (f64::from(k) / 16.0).exp2()).collect();
        let parts = |corner_hz: f64| -> Vec<Vec<f64>> {
            let low_pass = f_hz.iter().map(|f| 1.0 / (1.0 + (f / corner_hz).powi(2)));
            vec![low_pass.collect(), vec![1.0; f_hz.len()]]
        };
        // Without noise the truth is the maximum.
        let truth = parts(40.0);
        let psd = truth[0]
            .iter()
            .zip(&truth[1])
            .map(|(a, b)| 3.0 * a + 0.1 * b)
            .collect();
        let variances = DMatrix::from_diagonal_element(f_hz.len(), f_hz.len(), 0.01);
        let data = Data::from_parts(f_hz.clone(), psd, variances).expect("positive densities");
        for start_hz in [5.0_f64, 300.0] {
            let found = maximise_shape(&data, &[start_hz.ln()], &[0.3], |shape| {
                Some(parts(shape[0].exp()))
            })
            .expect("a fit");
            let corner_hz = found.shape[0].exp();
            assert!(
                (corner_hz / 40.0 - 1.0).abs() < 1e-3,
                "from {start_hz}: {corner_hz}"
            );
            assert!((found.fit.squared[0] / 3.0 - 1.0).abs() < 1e-3);
        }
    }
}
