//! Noise whose strength changes in time: how far it is from the steady noise of the same mean.

use super::detector::Contrast;
use super::grid::Grid;
use crate::hidden::scene::Scene;

/// Twice the log-likelihood ratio of noise whose white and quantisation terms are multiplied by
/// these factors (a sample of them, evenly in time) against steady noise of the same mean
/// spectrum.
pub fn contrast(factors: &[f64], scene: &Scene, axis: usize) -> Contrast {
    let grid = Grid::new(scene, &[]);
    let share = 1.0 / factors.len() as f64;
    let (mut mean, mut variance) = (0.0, 0.0);
    for (f_hz, weight) in grid.f_hz.iter().zip(&grid.weight) {
        let short = scene.short_density(axis, *f_hz) / scene.density(axis, *f_hz);
        let at = |factor: &f64| 1.0 + (factor * factor - 1.0) * short;
        let steady = factors.iter().map(at).sum::<f64>() * share;
        for factor in factors {
            let r = at(factor) / steady;
            mean += weight * share * (r - 1.0 - r.ln());
            variance += 2.0 * weight * share * (r - 1.0).powi(2);
        }
    }
    Contrast { mean, variance }
}
