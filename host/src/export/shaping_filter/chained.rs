//! Fast noises behind a signal chain: one filter of low order that has their spectrum.

use crate::export::factor::Factor;
use crate::export::state_space::StateSpace;
use crate::model::Term;
use crate::model::axis::ModelAxis;
use crate::model::kernel::{self, Kernel};
use crate::model::law::Law;

/// Error of the Allan deviation that the order of the chain's filter is chosen for, as a part.
const AIM: f64 = 0.005;

/// Fast noises behind the chain, up to its low-pass `sections`, by a filter of the lowest order
/// that is good enough.
pub(super) fn chained(
    axis: &ModelAxis,
    terms: &[Box<dyn Term>],
    sections: &[f64],
    rate_hz: f64,
) -> StateSpace {
    let law = Law::new(
        &ModelAxis {
            effects: Vec::new(),
            ..axis.clone()
        },
        rate_hz,
    );
    let density = |f_hz: f64| {
        let ahead: f64 = terms
            .iter()
            .map(|term| law.density_ahead(&**term, f_hz))
            .sum();
        ahead * law.power(f_hz)
    };
    let factor = Factor::new(density, sections, rate_hz);
    // Longer than any memory of the chain's; beyond, the density at zero alone counts.
    let taus: Vec<u64> = (0..18).map(|k| 1 << k).collect();
    let wanted: Vec<f64> = taus
        .iter()
        .map(|&m| kernel::variance(Kernel::Allan, m, rate_hz, density))
        .collect();
    let error = |system: &StateSpace| {
        let system = system.cascade(sections).settled();
        taus.iter()
            .zip(&wanted)
            .map(|(&m, wanted)| ((system.allan_variance(m) / wanted).sqrt() - 1.0).abs())
            .fold(0.0, f64::max)
    };
    let mut best = (f64::INFINITY, StateSpace::empty());
    for order in 1..=Factor::MOST {
        let Some(system) = factor.truncated(order, "band-limited noise") else {
            continue;
        };
        let error = error(&system);
        if error < best.0 {
            best = (error, system);
        }
        if error < AIM {
            break;
        }
    }
    best.1
}
