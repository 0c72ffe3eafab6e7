//! How far the spectrum of the truth is from the nearest law of a rival family.

use nalgebra::{DMatrix, DVector};

use super::detector::Contrast;
use super::grid::Grid;

/// Twice the log-likelihood ratio (Whittle 1953) of the law `truth` against the nearest sum of
/// `parts`, each with a factor of zero or more. The weak are told apart by this alone: whatever
/// the base can imitate does not count as evidence.
pub fn contrast(truth: &[f64], parts: &[Vec<f64>], grid: &Grid) -> Contrast {
    let relative: Vec<Vec<f64>> = parts
        .iter()
        .map(|part| part.iter().zip(truth).map(|(p, s)| p / s).collect())
        .collect();
    let factors = nearest(&relative, &grid.weight);
    against(&ratio(&relative, &factors), &grid.weight)
}

/// [`contrast`] against the nearest of several families.
pub fn contrast_nearest(
    truth: &[f64],
    families: impl Iterator<Item = Vec<Vec<f64>>>,
    grid: &Grid,
) -> Contrast {
    families
        .map(|parts| contrast(truth, &parts, grid))
        .min_by(|a, b| a.mean.total_cmp(&b.mean))
        .unwrap_or(Contrast::shift(0.0))
}

/// Contrast of the truth against a law that is `ratio` times as large.
fn against(ratio: &[f64], weight: &[f64]) -> Contrast {
    let (mut mean, mut variance) = (0.0, 0.0);
    for (q, w) in ratio.iter().zip(weight) {
        // Twice the log-ratio of one coefficient x^2 = S u: u (1/q - 1) + ln q, u chi-squared.
        mean += w * (1.0 / q - 1.0 + q.ln());
        variance += 2.0 * w * (1.0 / q - 1.0).powi(2);
    }
    Contrast { mean, variance }
}

fn ratio(relative: &[Vec<f64>], factors: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; relative.first().map_or(0, Vec::len)];
    for (part, factor) in relative.iter().zip(factors) {
        for (total, value) in sum.iter_mut().zip(part) {
            *total += factor * value;
        }
    }
    sum
}

/// Factors that bring the sum nearest to one: multiplicative steps to get near (Févotte, Bertin
/// and Durrieu 2009), then Fisher scoring.
fn nearest(relative: &[Vec<f64>], weight: &[f64]) -> Vec<f64> {
    let count = relative.len() as f64;
    let mut factors: Vec<f64> = relative
        .iter()
        .map(|part| 1.0 / (count * part.iter().copied().fold(0.0, f64::max)))
        .collect();
    for _ in 0..30 {
        let q = ratio(relative, &factors);
        for (factor, part) in factors.iter_mut().zip(relative) {
            let (mut above, mut below) = (0.0, 0.0);
            for ((a, q), w) in part.iter().zip(&q).zip(weight) {
                above += w * a / (q * q);
                below += w * a / q;
            }
            *factor *= (above / below).sqrt();
        }
    }
    let mut now = against(&ratio(relative, &factors), weight).mean;
    for _ in 0..40 {
        let goal = scoring_step(relative, &factors, weight);
        let mut share = 1.0;
        let better = loop {
            let trial: Vec<f64> = factors
                .iter()
                .zip(&goal)
                .map(|(from, to)| from + share * (to - from))
                .collect();
            let mean = against(&ratio(relative, &trial), weight).mean;
            if mean < now {
                factors = trial;
                break now - mean;
            }
            share *= 0.5;
            if share < 1e-4 {
                break 0.0;
            }
        };
        now -= better;
        if better < 1e-4 {
            break;
        }
    }
    factors
}

/// Weighted least squares of one on the parts, factors held at zero or above: parts that come
/// out negative are left out, the most negative first.
fn scoring_step(relative: &[Vec<f64>], factors: &[f64], weight: &[f64]) -> Vec<f64> {
    let q = ratio(relative, factors);
    // Scaled by the present factors, so that the matrix is of order one.
    let scale: Vec<f64> = relative
        .iter()
        .map(|part| 1.0 / part.iter().copied().fold(0.0, f64::max))
        .collect();
    let weights: Vec<f64> = q.iter().zip(weight).map(|(q, w)| w / (q * q)).collect();
    let mut free: Vec<usize> = (0..relative.len()).collect();
    loop {
        let size = free.len();
        let mut matrix = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        for (row, &i) in free.iter().enumerate() {
            for (column, &j) in free.iter().enumerate().skip(row) {
                let sum: f64 = relative[i]
                    .iter()
                    .zip(&relative[j])
                    .zip(&weights)
                    .map(|((a, b), w)| a * b * w)
                    .sum();
                matrix[(row, column)] = sum * scale[i] * scale[j];
                matrix[(column, row)] = matrix[(row, column)];
            }
            let sum: f64 = relative[i].iter().zip(&weights).map(|(a, w)| a * w).sum();
            right[row] = sum * scale[i];
        }
        let Some(solved) = matrix.cholesky().map(|factor| factor.solve(&right)) else {
            return factors.to_vec();
        };
        let worst = (0..size).min_by(|&a, &b| solved[a].total_cmp(&solved[b]));
        match worst {
            Some(row) if solved[row] < 0.0 && size > 1 => {
                free.remove(row);
            }
            _ => {
                let mut result = vec![0.0; relative.len()];
                for (row, &i) in free.iter().enumerate() {
                    result[i] = solved[row] * scale[i];
                }
                return result;
            }
        }
    }
}
