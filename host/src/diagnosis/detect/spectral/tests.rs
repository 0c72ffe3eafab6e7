//! What is named of the laws that fit, and what of it is none.

use super::*;
use crate::diagnosis::detect::trial::{self, Trial, noise};
use crate::diagnosis::laws::Law;
use crate::model::random::{Gaussian, Seed};
use crate::model::{sinusoid, steps, telegraph as two_levels};

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
    trial.refused.push(resonance::KIND);
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
    // The same spectrum of normal amplitudes: a correlation time of 1/8 s.
    let keep = (-8.0 / trial::RATE_HZ).exp();
    let mut normal = Gaussian::new(
        Seed { seed: 5, stream: 4 },
        2.0 * f64::sqrt(1.0 - keep * keep),
    );
    let mut level = 0.0;
    let values = noise(5).into_iter().map(|value| {
        level = keep * level + normal.draw();
        value + level
    });
    let trial = Trial::new(values.collect());
    assert_eq!(
        trial::kinds(&trial.ask(&DETECTOR)),
        [markov::KIND],
        "seed 5"
    );
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
    // Two levels that jumps were named: there is more of it.
    let proposals = with(&jumps, two_levels::KIND).ask(&DETECTOR);
    assert!(trial::withdraws(&proposals, two_levels::KIND), "seed 6");
    assert!(trial::kinds(&proposals).is_empty(), "seed 6");
    // Jumps the same way are none of it.
    let same = [at(100), at(200)];
    let proposals = with(&same, steps::KIND).ask(&DETECTOR);
    assert!(!trial::withdraws(&proposals, steps::KIND), "seed 6");
}
