//! What comes a few times in a record, such as a thermostat, and its multiples.

use super::*;
use crate::diagnosis::record::reading::Reading;

/// Noise under a heater that is on for three tenths of each of so many cycles, behind a lag.
fn heated(seed: u64, cycles: f64) -> Vec<f64> {
    let mut values = noise(seed);
    let length = values.len() as f64;
    // As if it had always been so.
    let mut level = 0.3;
    for (n, value) in values.iter_mut().enumerate() {
        let turn = (cycles * n as f64 / length).fract();
        let is_on = f64::from(u8::from(turn < 0.3));
        level += (is_on - level) * (20.0 * cycles / length);
        *value += 4.0 * level;
    }
    values
}

/// Frequencies over that of one cycle a record, and how many lines they have, of what is proposed.
fn proposed(trial: &Trial) -> Vec<(Kind, f64, usize)> {
    let duration_s = trial.axis.filled.len() as f64 / trial.axis.rate_hz;
    let of = |one: Proposal| match one {
        Proposal::Explain(candidate) => {
            let values = &candidate.effect.values;
            let f_hz = values[0].expect("a frequency").value;
            let lines = candidate.change.clone();
            let Change::Waves(waves) = lines else {
                panic!("{lines:?}")
            };
            (candidate.effect.kind, f_hz * duration_s, waves.len())
        }
        other => panic!("{other:?}"),
    };
    trial.ask(&DETECTOR).into_iter().map(of).collect()
}

#[test]
fn a_thermostat_is_one_cause_with_its_multiples() {
    for (seed, cycles) in [(30, 21.3), (31, 33.0), (32, 26.8)] {
        let mut trial = Trial::new(heated(seed, cycles));
        // The base hides multiples beside it at first.
        for _ in 0..4 {
            for proposal in trial.ask(&DETECTOR) {
                if let Proposal::Explain(candidate) = proposal {
                    trial.accept(*candidate);
                }
            }
        }
        let [one, others @ ..] = trial.axis.explanations() else {
            panic!("seed {seed}: nothing")
        };
        let f_hz = one.effect.values[0].expect("a frequency").value;
        let duration_s = trial.axis.filled.len() as f64 / trial.axis.rate_hz;
        assert_eq!(one.kind(), hum::KIND, "seed {seed}");
        let off = (f_hz * duration_s - cycles).abs();
        assert!(off < 0.1, "seed {seed}: {off} cycles a record");
        assert!(one.waves().len() >= 3, "seed {seed}");
        // What was found while its base was not known stays by itself.
        for other in others {
            let number = other.effect.values[0].expect("a frequency").value / f_hz;
            assert_eq!(other.kind(), sinusoid::KIND, "seed {seed}");
            assert!(
                (number - number.round()).abs() < 0.05,
                "seed {seed}: {number}"
            );
        }
    }
}

#[test]
fn what_may_follow_a_temperature_is_no_cycle() {
    let mut trial = Trial::new(heated(33, 20.0));
    assert!(!proposed(&trial).is_empty(), "seed 33");
    let column: Vec<f64> = (0..trial.axis.residual.len())
        .map(|n| (n as f64 * 1e-3).sin())
        .collect();
    trial.covariate = Some(Reading::of(&column));
    assert!(proposed(&trial).is_empty(), "seed 33");
}

#[test]
fn a_resonance_of_few_cycles_gives_its_place_to_a_line_that_is_worth_more() {
    let is_line = |trial: &Trial, cycles: f64, worth: f64| {
        trial.look(|look| {
            in_place_of(look, cycles / look.duration_s(), 1e-9, worth)
                .expect("what is left can be fitted")
                .is_some()
        })
    };
    for (seed, cycles) in [(60, 8.3), (61, 17.6)] {
        let mut values = noise(seed);
        let length = values.len() as f64;
        for (n, value) in values.iter_mut().enumerate() {
            *value += 0.2 * (TAU * cycles * n as f64 / length).sin();
        }
        let trial = Trial::new(values);
        // A fiftieth of the noise's variance in one of some ten thousand ordinates: hundreds of nats.
        assert!(is_line(&trial, cycles, 20.0), "seed {seed}");
        assert!(!is_line(&trial, cycles, 1e4), "seed {seed}: worth less");
        assert!(!is_line(&trial, 4.0, 20.0), "seed {seed}: a course");
    }
}
