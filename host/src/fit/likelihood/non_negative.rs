//! Least squares under `x >= 0` from the normal equations, for any number of unknowns.
//!
//! The active-set method of C. L. Lawson and R. J. Hanson, *Solving Least Squares Problems*
//! (1974), chapter 23: unknowns enter one at a time, the one that promises most first, and leave
//! again where the plain solution would make them negative.

use nalgebra::{DMatrix, DVector};

/// Relative slope below which an unknown at zero stays there.
const SLOPE: f64 = 1e-10;

/// Added to the unit diagonal, so that unknowns that cannot be distinguished share.
const RIDGE: f64 = 1e-12;

/// Minimises `x' G x / 2 - h' x` under `x >= 0`. `gram` is symmetric, with a diagonal that is
/// positive wherever an unknown may be anything but zero.
pub fn solve(gram: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    solve_from(gram, right, &DVector::zeros(right.len()))
}

/// The same, looked for from `near`, of which the unknowns above zero are let in at once. Where the answer is much the same,
/// as from one step of a search to the next, so is the work of letting in one by one saved.
pub fn solve_from(gram: &DMatrix<f64>, right: &DVector<f64>, near: &DVector<f64>) -> DVector<f64> {
    let size = right.len();
    let (unit, g, h) = normalised(gram, right);
    let threshold = SLOPE * h.amax();
    let is_free = |i: &usize| unit[*i] > 0.0 && near[*i] > 0.0;
    let mut free: Vec<usize> = (0..size).filter(is_free).collect();
    let mut x = DVector::zeros(size);
    free.iter().for_each(|&i| x[i] = near[i] / unit[i]);
    descend(&g, &h, &mut x, &mut free);
    for _ in 0..3 * size {
        let slope = &h - &g * &x;
        let best = (0..size)
            .filter(|i| unit[*i] > 0.0 && !free.contains(i) && slope[*i] > threshold)
            .max_by(|&i, &j| slope[i].total_cmp(&slope[j]));
        let Some(entering) = best else { break };
        free.push(entering);
        descend(&g, &h, &mut x, &mut free);
    }
    x.component_mul(&unit)
}

/// From `x`, which is positive in the unknowns `free` but for one that enters, to the least in as many of them as stay positive.
fn descend(g: &DMatrix<f64>, h: &DVector<f64>, x: &mut DVector<f64>, free: &mut Vec<usize>) {
    while !free.is_empty()
        && let Some(plain) = plain(g, h, free)
    {
        if plain.iter().all(|&value| value > 0.0) {
            x.fill(0.0);
            free.iter()
                .zip(&plain)
                .for_each(|(&i, &value)| x[i] = value);
            break;
        }
        // As far towards the plain solution as all stay positive.
        let ends = free.iter().zip(&plain).filter(|&(_, &value)| value <= 0.0);
        let steps = ends.map(|(&i, &value)| (i, x[i] / (x[i] - value)));
        let first = steps.min_by(|a, b| a.1.total_cmp(&b.1));
        let step = first.map_or(1.0, |(_, step)| step);
        for (&i, &value) in free.iter().zip(&plain) {
            x[i] += step * (value - x[i]);
        }
        // The one that ends first is there, even where the step to it is too small to be told from none.
        if let Some((ended, _)) = first {
            x[ended] = 0.0;
        }
        let tiny = 1e-14 * x.amax();
        free.retain(|&i| x[i] > tiny);
        (0..x.len())
            .filter(|i| !free.contains(i))
            .for_each(|i| x[i] = 0.0);
    }
}

/// Minimises `x' G x / 2 - h' x` without bounds; zero for unknowns that do not appear in it.
pub fn solve_any(gram: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let (unit, g, h) = normalised(gram, right);
    let free: Vec<usize> = (0..right.len()).filter(|&i| unit[i] > 0.0).collect();
    let mut x = DVector::zeros(right.len());
    if let Some(plain) = plain(&g, &h, &free) {
        free.iter().zip(plain).for_each(|(&i, value)| x[i] = value);
    }
    x.component_mul(&unit)
}

/// The problem in unknowns whose columns have length one: their units, and both sides.
fn normalised(
    gram: &DMatrix<f64>,
    right: &DVector<f64>,
) -> (DVector<f64>, DMatrix<f64>, DVector<f64>) {
    let unit = gram.diagonal().map(|length| {
        if length > 0.0 {
            1.0 / length.sqrt()
        } else {
            0.0
        }
    });
    let g = DMatrix::from_fn(right.len(), right.len(), |i, j| {
        gram[(i, j)] * unit[i] * unit[j] + if i == j { RIDGE } else { 0.0 }
    });
    let h = right.component_mul(&unit);
    (unit, g, h)
}

/// Solution in the unknowns `free` alone.
fn plain(g: &DMatrix<f64>, h: &DVector<f64>, free: &[usize]) -> Option<Vec<f64>> {
    let part = DMatrix::from_fn(free.len(), free.len(), |i, j| g[(free[i], free[j])]);
    let right = DVector::from_fn(free.len(), |i, _| h[free[i]]);
    let solution = part.cholesky()?.solve(&right);
    Some(solution.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::super::super::least_squares;
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn what_is_hardly_above_zero_ends_there() {
        // From the smallest number there is, a step towards -2 is none.
        let gram = DMatrix::from_element(1, 1, 1.0);
        let right = DVector::from_element(1, -2.0);
        let near = DVector::from_element(1, 5e-324);
        assert_eq!(solve_from(&gram, &right, &near)[0], 0.0);
    }

    #[test]
    fn agrees_with_trying_every_choice() {
        for seed in 0..200 {
            let mut random = rand_pcg::Pcg64::new(seed, 3);
            let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
            let a = DMatrix::from_fn(8, 4, |_, j| draw() * 10_f64.powi(3 * j as i32));
            let y = DVector::from_fn(8, |_, _| draw());
            let best = least_squares::solve_non_negative(&a, &y);
            let found = solve(&(a.transpose() * &a), &(a.transpose() * &y));
            for j in 0..4 {
                let error = (found[j] - best[j]).abs() * a.column(j).norm();
                assert!(error < 1e-8 * y.norm(), "seed {seed}, {j}: {found} {best}");
            }
            // From anywhere else it is the same.
            let near = DVector::from_fn(4, |j, _| draw().max(0.0) / a.column(j).norm());
            let again = solve_from(&(a.transpose() * &a), &(a.transpose() * &y), &near);
            for j in 0..4 {
                let error = (again[j] - best[j]).abs() * a.column(j).norm();
                assert!(error < 1e-8 * y.norm(), "seed {seed}, {j}: {again} {best}");
            }
        }
    }
}
