//! The effects that a model can hold beyond the five terms: one line each.

use super::kind::Kind;
use super::{
    averaging, burst, clipping, common_mode, cyclic, drift, dropped, held, highpass, hum, markov,
    motion, outliers, powerlaw, resonance, rolloff, rounding, shock, sinusoid, stale, steps,
    telegraph, thermal, timebase, unnamed, wandering_line, warmup,
};

/// All effects of the catalogue.
pub static CATALOGUE: &[Kind] = &[
    sinusoid::KIND,
    markov::KIND,
    resonance::KIND,
    powerlaw::KIND,
    rolloff::KIND,
    averaging::KIND,
    highpass::KIND,
    hum::KIND,
    wandering_line::KIND,
    telegraph::KIND,
    steps::KIND,
    shock::KIND,
    motion::KIND,
    warmup::KIND,
    drift::KIND,
    thermal::KIND,
    outliers::KIND,
    stale::KIND,
    held::KIND,
    dropped::KIND,
    clipping::KIND,
    rounding::KIND,
    burst::KIND,
    cyclic::KIND,
    common_mode::KIND,
    timebase::KIND,
    unnamed::KIND,
];

/// The effect called `name`.
pub fn find(name: &str) -> Option<Kind> {
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
            let values = in_order(&**effect, &named).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(values.len(), parameters.len(), "{}", effect.name());
        }
    }
}
