//! What of a model has no name, and how much it matters.

use rayon::prelude::*;

use crate::diagnosis::result::finding::{Unnamed, UnnamedBand};
use crate::diagnosis::result::verdict::LEAST_INTERVALS;
use crate::diagnosis::result::views::AllanPoint;
use crate::model::axis::ModelAxis;
use crate::model::unnamed;

/// Of the law of the last model's `noise`, whose Allan deviation together with all courses is that of `points`; its
/// probability is `p_value`.
pub fn without_name(
    p_value: f64,
    noise: &ModelAxis,
    rate_hz: f64,
    points: &[AllanPoint],
) -> Unnamed {
    let mut rest = noise.clone();
    rest.effects.retain(|one| one.kind() != unnamed::KIND);
    let (all, rest) = (noise.law(rate_hz), rest.law(rate_hz));
    let judged = points
        .par_iter()
        .filter(|point| point.intervals >= LEAST_INTERVALS);
    let changes = judged.map(|point| {
        let own = all.allan_variance(point.m) - rest.allan_variance(point.m);
        let with = point.after.powi(2);
        100.0 * ((with / (with - own).max(0.0)).sqrt() - 1.0)
    });
    let mut bands: Vec<UnnamedBand> = noise
        .effects
        .iter()
        .filter(|one| one.kind() == unnamed::KIND)
        .map(|one| UnnamedBand {
            f_hz: one.values()[0],
            width_hz: one.values()[1],
            amplitude: one.values()[2],
        })
        .collect();
    bands.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    Unnamed {
        p_value,
        allan_change_percent: changes.reduce(|| 0.0, f64::max),
        bands,
    }
}
