//! What the bins are expected to be for each of the terms that show in the spectrum.

use crate::fit::design::Design;
use crate::model::Coefficient;
use crate::spectrum::Estimate;

/// The terms that have a spectrum, in the order of [`unit_expectations`]; the ramp has none.
pub const SEEN: [Coefficient; 4] = [
    Coefficient::K,
    Coefficient::B,
    Coefficient::N,
    Coefficient::Q,
];

/// Expectations of all bins for each of [`SEEN`] with coefficient 1, through the design's chain.
pub fn unit_expectations(estimate: &Estimate, design: &Design) -> Vec<Vec<f64>> {
    let nodes_hz = estimate.operator.nodes_hz();
    let power: Vec<f64> = nodes_hz.iter().map(|&f_hz| design.power(f_hz)).collect();
    SEEN.map(|coefficient| {
        let densities: Vec<f64> = nodes_hz
            .iter()
            .zip(&power)
            .map(|(&f_hz, power)| power * design.unit_spectrum(coefficient, f_hz))
            .collect();
        estimate.operator.apply(&densities)
    })
    .to_vec()
}
