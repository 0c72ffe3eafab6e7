//! What is a tone that wanders, and what looks like one.

mod rules;

use std::f64::consts::{SQRT_2, TAU};
use std::sync::Arc;

use super::*;
use crate::diagnosis::detect::trial::{self, RATE_HZ, Trial, noise};
use crate::diagnosis::laws::Law;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::trial::numbers;
use crate::model::Term;
use crate::model::kind::Kind;
use crate::model::random::Seed;
use crate::model::resonance::Resonance;
use crate::model::wander::Wander;
use crate::model::wandering_line::WanderingLine;
use crate::model::{burst, shock, sinusoid};

/// Noise with what a term makes, sample by sample times `size`.
fn with(seed: u64, term: &dyn Term, size: impl Fn(f64) -> f64) -> Trial {
    let mut values = noise(seed);
    let mut added = vec![0.0; values.len()];
    term.generator(RATE_HZ, Seed { seed, stream: 7 })
        .add_to(&mut added);
    for (n, (value, added)) in values.iter_mut().zip(added).enumerate() {
        *value += size(n as f64 / RATE_HZ) * added;
    }
    Trial::new(values)
}

/// A tone that wanders by 0.05 Hz over 5 s; in 10 s, over which it can be followed, its energy is 60.
fn tone(f_hz: f64, amplitudes: &[f64]) -> WanderingLine {
    WanderingLine {
        f_hz,
        wander: Wander {
            rms_hz: 0.05,
            time_s: 5.0,
        },
        amplitudes: amplitudes.to_vec(),
    }
}

/// What is named: its kind and its values.
fn found(trial: &Trial) -> Option<(Kind, Vec<Option<Value>>)> {
    let candidate = trial::candidate(trial.ask(&DETECTOR))?;
    Some((candidate.effect.kind, candidate.effect.values))
}

#[test]
fn a_tone_that_wanders_is_named_with_its_parameters() {
    let (mut inside, mut outside) = (0, Vec::new());
    for seed in 0..10 {
        let (kind, values) =
            found(&with(seed, &tone(20.0, &[0.5]), |_| 1.0)).expect("a plain tone");
        assert_eq!(kind, wandering_line::KIND, "seed {seed}");
        assert_eq!(values.len(), 4, "seed {seed}: {values:?}");
        for (value, truth) in values.into_iter().zip([20.0, 0.05, 5.0, 0.5]) {
            let value = value.expect("known");
            let (lo, hi) = (value.lo.expect("an end"), value.hi.expect("an end"));
            if (lo..=hi).contains(&truth) {
                inside += 1;
            } else {
                outside.push((seed, truth, value));
            }
        }
    }
    // Of 40 intervals of 95 %, seven or more miss with a probability of 0.3 %.
    assert!(outside.len() < 7, "{inside} hold, {outside:?} do not");
}

#[test]
fn its_bands_are_looked_at_by_nothing_else_and_it_is_in_the_model() {
    let mut trial = with(1, &tone(20.0, &[0.5, 0.4]), |_| 1.0);
    let candidate = trial::candidate(trial.ask(&DETECTOR)).expect("a plain tone");
    trial.accept(candidate);
    let bands_hz = trial.axis.excluded_hz();
    for f_hz in [20.0, 40.0] {
        assert!(
            bands_hz.iter().any(|band| band.contains(&f_hz)),
            "seed 1: {bands_hz:?}"
        );
    }
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 1: found again");
    assert!(
        trial.ask(&super::super::unsteady_band::DETECTOR).is_empty(),
        "seed 1"
    );
    let one = &trial.axis.explanations()[0];
    assert_eq!(one.with.tones, std::slice::from_ref(&one.effect), "seed 1");
    assert_eq!(one.without.tones, [], "seed 1");
}

#[test]
fn multiples_that_wander_together_are_one_and_the_mains_are_hum() {
    // At ten times the rate and so much faster that as much can be followed.
    let rate_hz = 10.0 * RATE_HZ;
    for (f_hz, amplitudes, kind) in [
        (37.0, [0.5, 0.0, 0.4], wandering_line::KIND),
        // The strongest is not the lowest.
        (37.0, [0.4, 0.6, 0.0], wandering_line::KIND),
        // Alone at thrice the mains.
        (150.0, [0.5, 0.0, 0.0], wandering_line::KIND),
        (50.0, [0.5, 0.0, 0.4], hum::KIND),
        (50.0, [0.0, 0.5, 0.0], hum::KIND),
    ] {
        let line = WanderingLine {
            wander: Wander {
                rms_hz: 0.1,
                time_s: 1.0,
            },
            ..tone(f_hz, &amplitudes)
        };
        let mut values = noise(2);
        line.generator(rate_hz, Seed { seed: 2, stream: 7 })
            .add_to(&mut values);
        let mut trial = Trial::new(noise(2));
        trial.axis = AxisState::new(Arc::new(values), rate_hz, None).expect("a spectrum");
        let (found, values) = found(&trial).expect("a plain tone");
        assert_eq!(found, kind, "seed 2, {f_hz} Hz");
        let amplitude = |number: usize| {
            let value = values.get(wandering_line::FIRST_AMPLITUDE + number);
            value.copied().flatten().map_or(0.0, |one| one.value)
        };
        for (number, expected) in amplitudes.into_iter().enumerate() {
            let off = (amplitude(number) - expected).abs();
            // Amplitudes are known to 2 %; what is not there is not named.
            assert!(off <= 0.1 * expected, "seed 2, {f_hz} Hz: {values:?}");
        }
    }
}

/// Its skirts fill one side of the band up to its end, so that the middle of what it fills is another frequency.
#[test]
fn mains_a_hundred_times_as_strong_as_the_noise_are_mains() {
    let rate_hz = 10.0 * RATE_HZ;
    for seed in 20..24 {
        let line = WanderingLine {
            wander: Wander {
                rms_hz: 0.02,
                time_s: 5.0,
            },
            ..tone(50.0, &[100.0, 0.0, 30.0])
        };
        let mut values = noise(seed);
        line.generator(rate_hz, Seed { seed, stream: 7 })
            .add_to(&mut values);
        let mut trial = Trial::new(noise(seed));
        trial.axis = AxisState::new(Arc::new(values), rate_hz, None).expect("a spectrum");
        let (kind, values) = found(&trial).expect("a plain tone");
        assert_eq!(kind, hum::KIND, "seed {seed}");
        let f_hz = values[0].expect("known").value;
        // Some independent frequencies of a deviation of 0.02 Hz.
        assert!((f_hz - 50.0).abs() < 0.06, "seed {seed}: {f_hz}");
    }
}

#[test]
fn a_tone_is_as_large_where_a_third_of_the_samples_is_missing() {
    for seed in 11..14 {
        let mut values = with(seed, &tone(20.0, &[2.0]), |_| 1.0)
            .axis
            .residual
            .measured()
            .to_vec();
        let mut drawn = numbers(seed, 5);
        for value in &mut values {
            // A third of normal numbers is below this.
            if drawn.draw() < -0.43 {
                *value = f64::NAN;
            }
        }
        let (kind, values) = found(&Trial::new(values)).expect("a plain tone");
        assert_eq!(kind, wandering_line::KIND, "seed {seed}");
        let amplitude = values[wandering_line::FIRST_AMPLITUDE]
            .expect("known")
            .value;
        // Known to some hundredths; with what is drawn counted as missing it is a fifth larger.
        assert!(
            (amplitude / 2.0 - 1.0).abs() < 0.1,
            "seed {seed}: {amplitude}"
        );
    }
}

#[test]
fn a_tone_goes_on_through_a_long_gap_once_it_is_known() {
    let seed = 15;
    let truth = with(seed, &tone(20.0, &[5.0]), |_| 1.0);
    let truth = truth.axis.residual.measured().to_vec();
    let gap = truth.len() / 2..truth.len() / 2 + 700;
    let mut values = truth.clone();
    values[gap.clone()].fill(f64::NAN);
    let mut trial = Trial::new(values);
    // The samples next to the ends, by which the tone has hardly moved.
    let near = (gap.start..gap.start + 4).chain(gap.end - 4..gap.end);
    let off = |trial: &Trial| {
        let squares = near
            .clone()
            .map(|n| (trial.axis.filled[n] - truth[n]).powi(2));
        (squares.sum::<f64>() / 8.0).sqrt()
    };
    let before = off(&trial);
    trial.accept(trial::candidate(trial.ask(&DETECTOR)).expect("a plain tone"));
    let after = off(&trial);
    // Two draws of noise of deviation 1 are 1.4 apart.
    assert!(
        before > 3.0 && after < 2.5,
        "seed {seed}: {before}, {after}"
    );
}

#[test]
fn a_multiple_within_an_excluded_band_is_none_of_it_and_what_is_refused_is_not_named() {
    let mut trial = with(1, &tone(20.0, &[0.5, 0.4]), |_| 1.0);
    let lines = |trial: &Trial| found(trial).map(|(_, values)| values.len());
    let both = wandering_line::FIRST_AMPLITUDE + 2;
    assert_eq!(lines(&trial), Some(both), "seed 1");
    trial.exclude(38.0, 42.0);
    assert_eq!(lines(&trial), Some(both - 1), "seed 1: excluded");
    trial.refuse(wandering_line::KIND);
    assert_eq!(lines(&trial), None, "seed 1: refused");
}

#[test]
fn what_was_named_for_it_goes() {
    let supersedes = |kind: Kind, change: Change| {
        let mut trial = with(5, &tone(20.0, &[0.5]), |_| 1.0);
        trial.know(kind, [20.0, 0.1, 0.1], change);
        let named = trial::candidate(trial.ask(&DETECTOR)).expect("a plain tone");
        named.supersedes.contains(&kind)
    };
    let line = |f_hz| Change::Waves(vec![trial::line(f_hz, 0.0)]);
    assert!(supersedes(sinusoid::KIND, line(20.02)), "seed 5");
    assert!(!supersedes(sinusoid::KIND, line(31.0)), "seed 5: elsewhere");
    // Laws are fitted to all of the spectrum.
    let law = Law {
        effect: resonance::KIND,
        values: vec![35.0, 2.0, 1.0],
    };
    assert!(supersedes(resonance::KIND, Change::Law(law)), "seed 5");
}

#[test]
fn stretches_louder_than_the_tone_could_make_them_stay() {
    // Half of a fifth of the noise's power is in the tone; the stretch is a fiftieth of the record.
    let is_back = |factor: f64| {
        let mut trial = with(5, &tone(20.0, &[0.5]), |_| 1.0);
        let record_s = trial.axis.filled.len() as f64 / RATE_HZ;
        let burst = [100.0, 100.0 + record_s / 50.0, factor, 0.0];
        trial.know(burst::KIND, burst, Change::Waves(Vec::new()));
        let named = trial::candidate(trial.ask(&DETECTOR)).expect("a plain tone");
        named.reopens.contains(&burst::KIND)
    };
    assert!(is_back(1.5), "seed 5: a fortieth of the noise's power");
    assert!(!is_back(6.0), "seed 5: seven tenths of it");
}

/// Noise at a thousand samples a second with mains whose multiples have these amplitudes and whose frequency wanders by 0.1 Hz, and
/// the seed of both.
fn wandering_mains(amplitudes: &[f64]) -> (Trial, u64) {
    let (rate_hz, seed) = (10.0 * RATE_HZ, 6);
    let line = WanderingLine {
        wander: Wander {
            rms_hz: 0.1,
            time_s: 1.0,
        },
        ..tone(50.0, amplitudes)
    };
    let mut values = noise(seed);
    line.generator(rate_hz, Seed { seed, stream: 7 })
        .add_to(&mut values);
    let mut trial = Trial::new(noise(seed));
    trial.axis = AxisState::new(Arc::new(values), rate_hz, None).expect("a spectrum");
    (trial, seed)
}

#[test]
fn steady_mains_that_were_found_first_go_for_mains_that_wander() {
    let (mut trial, seed) = wandering_mains(&[0.5]);
    trial.know(hum::KIND, [50.0, 0.1], Change::Waves(Vec::new()));
    let named = trial::candidate(trial.ask(&DETECTOR)).expect("plain mains");
    assert_eq!(named.effect.kind, hum::KIND, "seed {seed}");
    assert_eq!(named.supersedes, [hum::KIND], "seed {seed}");
}

#[test]
fn noise_that_rings_is_none_however_narrow() {
    for seed in 0..5 {
        for width_hz in [0.03, 0.1, 0.5, 2.0, 8.0] {
            let resonance = Resonance {
                f_hz: 20.0,
                width_hz,
                amplitude: 1.0,
            };
            let trial = with(seed, &resonance, |_| 1.0);
            let within = 20.0 - width_hz..20.0 + width_hz;
            let named = trial.look(|look| named(look, &within, 1e-9));
            assert!(named.is_none(), "seed {seed}, {width_hz} Hz: {named:?}");
        }
    }
}

#[test]
fn a_tone_that_stands_still_or_beats_or_stops_is_none() {
    let within = 19.8..20.2;
    let asked = |trial: &Trial| trial.look(|look| named(look, &within, 1e-9)).is_some();
    let wandering = tone(20.0, &[0.5]);
    assert!(asked(&with(3, &wandering, |_| 1.0)), "seed 3");
    let beats = |t_s: f64| SQRT_2 * (TAU * t_s / 15.0).sin();
    assert!(!asked(&with(3, &wandering, beats)), "seed 3: beats");
    let stops = |t_s: f64| if t_s < 90.0 { 1.0 } else { 0.0 };
    assert!(!asked(&with(3, &wandering, stops)), "seed 3: stops");
    let still = crate::model::sinusoid::Sinusoid {
        f_hz: 20.0,
        amplitude: 0.5,
    };
    assert!(!asked(&with(3, &still, |_| 1.0)), "seed 3: stands still");
}

#[test]
fn a_shock_that_rings_as_the_tone_does_is_the_tone() {
    for (f_hz, is_tone) in [(20.02, true), (31.0, false)] {
        let mut trial = with(4, &tone(20.0, &[0.5]), |_| 1.0);
        let shock = shock::Shock {
            time_s: 60.0,
            peak: 0.3,
            duration_s: 2.0,
            f_hz,
            decay_s: 1.0,
        };
        let values = [60.0, 0.3, 2.0, f_hz, 1.0];
        let wave = Wave::Shocks {
            shocks: vec![shock],
            rate_hz: RATE_HZ,
        };
        trial.know(shock::KIND, values, Change::Waves(vec![wave]));
        let named = trial::candidate(trial.ask(&DETECTOR)).expect("a plain tone");
        assert_eq!(named.effect.kind, wandering_line::KIND, "seed 4, {f_hz} Hz");
        let goes = named.supersedes.contains(&shock::KIND);
        assert_eq!(goes, is_tone, "seed 4, {f_hz} Hz");
    }
}
