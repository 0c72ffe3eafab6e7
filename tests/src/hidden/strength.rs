//! Strength 1: from where an ideal detector succeeds.

use super::effect::Effect;
use super::ideal::detector::Evidence;
use super::scene::Scene;

/// How strong to make what is hidden, in multiples of strength 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Strength {
    /// Uniform in the logarithm between these.
    Between(f64, f64),
    /// Just this.
    At(f64),
    /// From 1 to what the kind can be at most ([`wide`](super::wide)), in a record of any length, rate,
    /// noise and form.
    Any,
}

/// The effect at strength 1: the weakest that suffices (see
/// [`Evidence::suffices`]), to one percent. None where no strength between a
/// millionth and a million times the one given does.
pub fn unit(effect: &dyn Effect, scene: &Scene) -> Option<Box<dyn Effect>> {
    let evidence =
        |log_factor: f64| -> Evidence { effect.scaled(log_factor.exp()).evidence(scene) };
    let step = 4_f64.ln();
    let steps = (1e6_f64.ln() / step) as u32;
    let rungs = || (0..=steps).map(|rung| f64::from(rung) * step);
    let high = if evidence(0.0).suffices() {
        step - rungs().find(|rung| !evidence(-rung).suffices())?
    } else {
        rungs().find(|rung| evidence(*rung).suffices())?
    };
    let (mut low, mut high) = (high - step, high);
    while high - low > 0.01 {
        let middle = 0.5 * (low + high);
        if evidence(middle).suffices() {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(effect.scaled(high.exp()))
}
