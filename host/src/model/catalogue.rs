//! The effects that a model can hold beyond the five terms: one line each.

use super::effect::Effect;
use super::{
    burst, clipping, common_mode, dropped, hum, markov, outliers, powerlaw, resonance, rolloff,
    rounding, sinusoid, stale, steps, telegraph, thermal, timebase, warmup,
};

/// All effects.
pub static CATALOGUE: &[&dyn Effect] = &[
    &sinusoid::Kind,
    &markov::Kind,
    &resonance::Kind,
    &powerlaw::Kind,
    &rolloff::Kind,
    &hum::Kind,
    &telegraph::Kind,
    &steps::Kind,
    &warmup::Kind,
    &thermal::Kind,
    &outliers::Kind,
    &stale::Kind,
    &dropped::Kind,
    &clipping::Kind,
    &rounding::Kind,
    &burst::Kind,
    &common_mode::Kind,
    &timebase::Kind,
];

/// The effect called `name`.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    CATALOGUE.iter().copied().find(|one| one.name() == name)
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, HashSet};

    use super::*;
    use crate::model::effect::in_order;

    #[test]
    fn names_are_unique_and_parameters_keep_their_order() {
        let mut names = HashSet::new();
        for effect in CATALOGUE {
            assert!(names.insert(effect.name()), "{} twice", effect.name());
            // Enough values for a row; every effect says how many of them it takes.
            let parameters = effect.parameters(&[0.0; 4]);
            // 1 is in the range of every quantity.
            let named: BTreeMap<String, f64> = parameters
                .iter()
                .map(|one| (one.name.to_string(), 1.0))
                .collect();
            assert_eq!(named.len(), parameters.len(), "{}", effect.name());
            let values = in_order(*effect, &named).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(values.len(), parameters.len(), "{}", effect.name());
        }
    }
}
