//! How good a shaping filter is: the Allan deviation of its matrices against that of the model.

use super::Known;
use crate::export::state_space::StateSpace;
use crate::model::axis::ModelAxis;
use crate::model::law::Law;

/// Averaging times an octave at which deviations are compared.
const PER_OCTAVE: f64 = 2.0;

/// Allan variance that is nothing, as a part of the largest of the curve.
const NOTHING: f64 = 1e-9;

/// Agreement of the filter's Allan deviation with the model's.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Accuracy {
    /// Shortest averaging time compared, seconds.
    pub from_s: f64,
    /// Longest averaging time compared, seconds.
    pub to_s: f64,
    /// Largest difference of the deviations between them, percent of the model's.
    pub allan_deviation_percent: f64,
}

/// Largest difference to the model without what is left out.
pub(super) fn accuracy(
    system: &StateSpace,
    axis: &ModelAxis,
    known: &Known,
    rate_hz: f64,
    longest_s: f64,
) -> Accuracy {
    let law = Law::new(
        &ModelAxis {
            effects: known.effects.clone(),
            ..axis.clone()
        },
        rate_hz,
    );
    let longest = (longest_s * rate_hz).max(1.0);
    let steps = (longest.log2() * PER_OCTAVE).floor() as u32;
    let factors: std::collections::BTreeSet<u64> = (0..=steps)
        .map(|step| (f64::from(step) / PER_OCTAVE).exp2().round() as u64)
        .collect();
    let wanted: Vec<f64> = factors.iter().map(|&m| law.allan_variance(m)).collect();
    // A sinusoid alone has no variance at all at multiples of its period.
    let floor = NOTHING * wanted.iter().copied().fold(0.0, f64::max);
    let worst = factors
        .iter()
        .zip(&wanted)
        .filter(|(_, wanted)| **wanted > floor)
        .map(|(&m, wanted)| ((system.allan_variance(m) / wanted).sqrt() - 1.0).abs())
        .fold(0.0, f64::max);
    let last = factors.last().copied().unwrap_or(1);
    Accuracy {
        from_s: 1.0 / rate_hz,
        to_s: last as f64 / rate_hz,
        allan_deviation_percent: 100.0 * worst,
    }
}
