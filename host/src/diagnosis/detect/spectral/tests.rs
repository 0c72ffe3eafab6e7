//! What is named of the laws that fit, and what of it is none.

use super::*;
use crate::diagnosis::detect::trial::{self, Trial, noise};
use crate::diagnosis::laws::Law;
use crate::diagnosis::record::envelope::Envelope;
use crate::model::effect::Distortion;
use crate::model::highpass::{self, Coupling};
use crate::model::random::{Gaussian, Seed};
use crate::model::{cyclic, rolloff, sinusoid, steps, telegraph as two_levels};

/// Noise with a steady band about 20 Hz.
fn with_band(seed: u64, deviation: f64) -> Trial {
    let mut values = noise(seed);
    trial::add_band(&mut values, seed, deviation, |_| 1.0);
    Trial::new(values)
}

/// A law that is known.
fn known(trial: &mut Trial, f_hz: f64) {
    trial.axis.laws.push(Law {
        effect: resonance::KIND,
        values: vec![f_hz, 0.5, 1.0],
    });
}

#[test]
fn the_likeliest_law_is_named_if_it_is_open() {
    let mut trial = with_band(0, 0.4);
    assert_eq!(
        trial::kinds(&trial.ask(&DETECTOR)),
        [resonance::KIND],
        "seed 0"
    );
    trial.refuse(resonance::KIND);
    let others = trial::kinds(&trial.ask(&DETECTOR));
    assert!(!others.contains(&resonance::KIND), "seed 0: refused");
    let steady = trial::kinds(&Trial::new(noise(0)).ask(&DETECTOR));
    assert!(steady.is_empty(), "seed 0: {steady:?} of the five terms");
}

#[test]
fn where_the_strength_moves_a_law_must_be_plainer() {
    let mut trial = with_band(1, 0.2);
    let found = trial
        .look(significant)
        .expect("a record that can be fitted");
    trial.level = 10.0 * found[0].p_value;
    assert!(!trial.ask(&DETECTOR).is_empty(), "seed 1");
    trial.character.strength_moves = true;
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 1: moving");
    trial.character.strength_moves = false;
    let swing = Envelope {
        depth: 1e-3,
        period: 2000.0,
        phase_rad: 0.0,
    };
    trial.know(cyclic::KIND, [1e-3, 20.0, 0.0], Change::Strength(swing));
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 1: swinging");
}

#[test]
fn a_resonance_too_narrow_to_resolve_is_a_line() {
    let mut values = noise(2);
    trial::add(&mut values, &trial::line(13.3, 0.5));
    let trial = Trial::new(values);
    assert_eq!(
        trial::kinds(&trial.ask(&DETECTOR)),
        [sinusoid::KIND],
        "seed 2"
    );
}

#[test]
fn beyond_four_laws_none_is_named() {
    let mut trial = with_band(3, 0.4);
    (0..MOST_LAWS).for_each(|number| known(&mut trial, 2.0 + 3.0 * number as f64));
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 3");
}

#[test]
fn switching_goes_ahead_of_all_others_where_the_level_switches_and_has_no_law() {
    let mut trial = with_band(4, 0.4);
    assert!(trial.ask(&OF_SWITCHING).is_empty(), "seed 4");
    trial.character.level_switches = true;
    assert!(!trial.ask(&OF_SWITCHING).is_empty(), "seed 4: switches");
    known(&mut trial, 30.0);
    assert!(trial.ask(&OF_SWITCHING).is_empty(), "seed 4: has a law");
}

#[test]
fn two_levels_are_told_from_markov_noise() {
    let trial = Trial::new(trial::switching(5, 4.0).0);
    let proposals = trial.ask(&DETECTOR);
    assert!(trial::teaches(&proposals, &Lesson::LevelSwitches), "seed 5");
    let found = trial::candidate(proposals).expect("a plain law");
    assert_eq!(found.effect.kind, two_levels::KIND, "seed 5");
    assert!(found.supersedes.contains(&steps::KIND), "seed 5");
    assert!(
        found.rivals.iter().any(|one| one.effect == markov::KIND),
        "seed 5"
    );
    let trial = Trial::new(markov_like(5));
    assert_eq!(
        trial::kinds(&trial.ask(&DETECTOR)),
        [markov::KIND],
        "seed 5"
    );
}

/// Noise with the spectrum of a level that switches by 4, of normal amplitudes: a correlation time of 1/8 s.
fn markov_like(seed: u64) -> Vec<f64> {
    let keep = (-8.0 / trial::RATE_HZ).exp();
    let mut normal = Gaussian::new(Seed { seed, stream: 4 }, 2.0 * f64::sqrt(1.0 - keep * keep));
    let mut level = 0.0;
    let values = noise(seed).into_iter().map(|value| {
        level = keep * level + normal.draw();
        value + level
    });
    values.collect()
}

#[test]
fn two_levels_are_named_once_and_not_where_they_were_refused() {
    let switching = |character: bool| {
        let mut trial = Trial::new(trial::switching(7, 4.0).0);
        trial.character.level_switches = character;
        trial
    };
    let anywhere = |trial: &Trial| {
        let found = trial.look(switching_anywhere);
        found.expect("a record that can be fitted").is_some()
    };
    assert!(anywhere(&switching(false)), "seed 7");
    assert!(!anywhere(&switching(true)), "seed 7: known");
    let mut refused = switching(false);
    refused.refuse(two_levels::KIND);
    assert!(!anywhere(&refused), "seed 7: refused");
    assert_eq!(
        trial::kinds(&refused.ask(&DETECTOR)),
        [markov::KIND],
        "seed 7: refused"
    );
    let mut known = switching(true);
    known.know(two_levels::KIND, [4.0, 0.25], trial::steps(&[]));
    assert_eq!(
        trial::kinds(&known.ask(&DETECTOR)),
        [markov::KIND],
        "seed 7: a second one"
    );
}

#[test]
fn jumps_beside_noise_that_does_not_switch_stay() {
    let jumps = [trial::jump(6000, 4.0), trial::jump(9000, -4.0)];
    let mut values = markov_like(8);
    trial::add(
        &mut values,
        &crate::diagnosis::record::wave::Wave::Steps(jumps.to_vec()),
    );
    let mut trial = Trial::new(values);
    trial.know(steps::KIND, [60.0, 4.0], trial::steps(&jumps));
    let proposals = trial.ask(&DETECTOR);
    assert!(!trial::withdraws(&proposals, steps::KIND), "seed 8");
    assert_eq!(trial::kinds(&proposals), [markov::KIND], "seed 8");
}

#[test]
fn jumps_that_belong_to_a_switching_are_put_back() {
    let (values, moments) = trial::switching(6, 4.0);
    let height = |place: usize| if place.is_multiple_of(2) { -4.0 } else { 4.0 };
    let at = |place: usize| trial::jump(moments[place], height(place));
    let with = |jumps: &[_], kind: Kind| {
        let mut trial = Trial::new(values.clone());
        trial.know(kind, [4.0, 10.0], trial::steps(jumps));
        trial
    };
    let jumps = [at(100), at(201)];
    let proposals = with(&jumps, steps::KIND).ask(&DETECTOR);
    assert!(trial::withdraws(&proposals, steps::KIND), "seed 6");
    assert!(trial::teaches(&proposals, &Lesson::LevelSwitches), "seed 6");
    assert_eq!(trial::kinds(&proposals), [two_levels::KIND], "seed 6");
    let mut refused = with(&jumps, steps::KIND);
    refused.refuse(two_levels::KIND);
    assert!(
        !trial::withdraws(&refused.ask(&DETECTOR), steps::KIND),
        "seed 6: refused"
    );
    // Jumps of twice the height are none of it.
    let high = [(100, -8.0), (101, 8.0)].map(|(place, height)| trial::jump(moments[place], height));
    let proposals = with(&high, steps::KIND).ask(&DETECTOR);
    assert!(
        !trial::withdraws(&proposals, steps::KIND),
        "seed 6: twice as high"
    );
    // Two levels that jumps were named: there is more of it.
    let proposals = with(&jumps, two_levels::KIND).ask(&DETECTOR);
    assert!(trial::withdraws(&proposals, two_levels::KIND), "seed 6");
    assert!(trial::kinds(&proposals).is_empty(), "seed 6");
    // Jumps the same way are none of it.
    let same = [at(100), at(200)];
    let proposals = with(&same, steps::KIND).ask(&DETECTOR);
    assert!(!trial::withdraws(&proposals, steps::KIND), "seed 6");
}

#[test]
fn a_line_is_a_narrow_resonance_whose_power_stands_at_one_frequency() {
    let mut values = noise(9);
    trial::add(&mut values, &trial::line(13.3, 0.5));
    Trial::new(values).look(|look| {
        let found = significant(look).expect("a record that can be fitted");
        let mut one = found.into_iter().next().expect("a plain law");
        let mut is_it = |effect: Kind, width_hz: f64| {
            one.law = Law {
                effect,
                values: vec![13.3, width_hz, 1.0],
            };
            is_line(look, &one)
        };
        // Far wider than 1/T.
        assert!(is_it(resonance::KIND, 0.5), "seed 9");
        assert!(!is_it(resonance::KIND, 2.0), "seed 9: bins resolve it");
        assert!(!is_it(markov::KIND, 0.5), "seed 9: no resonance");
    });
}

#[test]
fn of_two_laws_that_gain_as_much_the_one_of_fewer_numbers_is_worth_more() {
    let trial = with_band(10, 0.4);
    let found = trial
        .look(significant)
        .expect("a record that can be fitted");
    let mut one = found.into_iter().next().expect("a plain law");
    let mut with = |values: usize| {
        one.law.values.resize(values, 1.0);
        worth(trial::RATE_HZ, &one)
    };
    assert_eq!(with(2) - with(3), 1.0, "seed 10");
}

#[test]
fn a_roll_off_that_hardly_anybody_builds_costs_more() {
    let cost_at = |share: f64| {
        let law = Law {
            effect: crate::model::rolloff::KIND,
            values: vec![share * trial::RATE_HZ],
        };
        cost(trial::RATE_HZ, &law)
    };
    assert_eq!(cost_at(0.3), 1.0);
    assert_eq!(cost_at(0.021), 1.0);
    assert!(cost_at(0.019) >= 3.0, "below a fiftieth of the rate");
}

#[test]
fn noise_that_forgets_within_two_samples_costs_more() {
    let cost_at = |samples: f64| {
        let law = Law {
            effect: markov::KIND,
            values: vec![1.0, samples / trial::RATE_HZ],
        };
        cost(trial::RATE_HZ, &law)
    };
    assert_eq!(cost_at(2.1), 2.0);
    assert!(cost_at(1.9) >= 5.0, "as a filter does");
}

#[test]
fn a_mean_over_any_number_of_samples_is_found_and_lines_are_asked_anew() {
    for (seed, samples) in (80..).zip([1.7, 4.7, 11.3, 20.9, 28.6]) {
        let trial = Trial::new(trial::averaged(noise(seed), samples));
        let candidate = trial::candidate(trial.ask(&DETECTOR));
        let candidate = candidate.unwrap_or_else(|| panic!("seed {seed}: nothing"));
        let Change::Law(law) = &candidate.change else {
            panic!("seed {seed}: no law");
        };
        assert_eq!(law.effect, averaging::KIND, "seed {seed}");
        let found = law.values[0] * trial::RATE_HZ;
        assert!((found / samples - 1.0).abs() < 0.01, "seed {seed}: {found}");
        for kind in [sinusoid::KIND, hum::KIND] {
            assert!(candidate.reopens.contains(&kind), "seed {seed}: {kind}");
        }
    }
}

/// White noise behind a pole at this share of the rate.
fn behind_a_pole(seed: u64, share: f64) -> Trial {
    let mut normal = Gaussian::new(Seed { seed, stream: 3 }, 1.0);
    let kept = (-std::f64::consts::TAU * share).exp();
    let mut level = 0.0;
    let values = (0..40_001).map(|_| {
        level = kept * level + (1.0 - kept) * normal.draw();
        level
    });
    Trial::new(values.collect())
}

#[test]
fn what_falls_from_below_a_hundredth_of_the_rate_is_no_rolloff() {
    for seed in 0..3 {
        // The corner that a search finds, as a share of the rate.
        let corner = |share: f64| {
            let trial = behind_a_pole(seed, share);
            let found = trial
                .look(significant)
                .expect("a record that can be fitted");
            let mut found = found.into_iter();
            let rolloff = found.find(|one| one.law.effect == rolloff::KIND)?;
            Some(rolloff.law.values[0] / trial::RATE_HZ)
        };
        let found = [0.03, 0.006].map(corner);
        assert!(
            found[0].is_some_and(|at| at > 0.02),
            "seed {seed}: {found:?}"
        );
        assert!(
            found[1].is_none_or(|at| at > 0.01),
            "seed {seed}: {found:?}"
        );
    }
}

#[test]
fn what_is_seldom_built_has_less_of_the_level() {
    let mut values = noise(4);
    let seed = Seed { seed: 4, stream: 9 };
    let coupling = Coupling::of(&[0.2]);
    coupling.distorter(trial::RATE_HZ, seed).apply(&mut values);
    let mut trial = Trial::new(values);
    let starts = trial.axis.starts().expect("bins");
    let found = search::search(trial.axis.fitted(), &starts, highpass::KIND).expect("a coupling");
    // It costs five nats, or a hundred and fifty in the level.
    for (times, is_named) in [(10.0, false), (1000.0, true)] {
        trial.level = times * found.p_value;
        let kinds = trial::kinds(&trial.ask(&DETECTOR));
        let names = kinds.contains(&highpass::KIND);
        assert_eq!(names, is_named, "seed 4, {:e}: {kinds:?}", found.p_value);
    }
}
