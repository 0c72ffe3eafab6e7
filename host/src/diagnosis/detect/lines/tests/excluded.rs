//! Lines in records of which stretches are excluded: what is drawn there in the place of the record has none of them.

use super::*;
use crate::diagnosis::detect::wandering_line as wandering;
use crate::model::burst;

/// Noise with a line at 3.7 Hz of this amplitude, of which two stretches are excluded, an eighth of it or more.
fn excluded(seed: u64, amplitude: f64) -> Trial {
    let mut values = noise(seed);
    trial::add(&mut values, &trial::line(3.7, -amplitude));
    let mut trial = Trial::new(values);
    let masked = vec![3001..5602, 12_345..15_001];
    trial.know(burst::KIND, [30.0, 150.0, 3.0], Change::Mask(masked));
    trial
}

#[test]
fn its_amplitude_is_that_of_what_is_left() {
    for seed in 20..23 {
        let trial = excluded(seed, 3.0);
        let line = trial::candidate(trial.ask(&DETECTOR)).expect("a plain line");
        assert_eq!(line.effect.kind, sinusoid::KIND, "seed {seed}");
        let amplitude = line.effect.values[1].expect("a size");
        // Beside 4.5 deviations, by chance once in 10^5, a thousandth of it: the search ends there.
        let off = (amplitude.value - 3.0).abs();
        assert!(
            off < 4.5 * amplitude.sd() + 3e-3,
            "seed {seed}: {amplitude:?}"
        );
    }
}

#[test]
fn it_does_not_wander_for_them() {
    for seed in 23..26 {
        let trial = excluded(seed, 3.0);
        let found = trial::kinds(&trial.ask(&wandering::DETECTOR));
        assert!(found.is_empty(), "seed {seed}: {found:?}");
        let found = trial.look(|look| wandering::named(look, &(3.6..3.8), 1e-9).is_some());
        assert!(!found, "seed {seed}");
    }
}
