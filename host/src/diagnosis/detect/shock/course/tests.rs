//! What is told of an event, and what is not.

use std::f64::consts::TAU;

use super::*;
use crate::diagnosis::detect::shock::fit;
use crate::diagnosis::detect::shock::trial::{self, EVENT, ringing};
use crate::diagnosis::detect::trial::noise;

/// Ringing of 0.1 cycles a sample in noise that is `loud` within it, fitted.
fn fitted(seed: u64, loud: f64) -> (About, Fitted) {
    let mut values = noise(seed);
    values[EVENT].iter_mut().for_each(|one| *one *= loud);
    ringing(EVENT.start as f64, 300.0, 0.1, 30.0).add_to(0, &mut values, 1.0);
    let about = trial::about(&values);
    let fitted = fit::fit(&about).unwrap_or_else(|| panic!("seed {seed}: no fit"));
    (about, fitted)
}

#[test]
fn a_course_that_leaves_much_is_not_of_its_form() {
    for seed in 0..3 {
        let (about, mut fitted) = fitted(seed, 1.0);
        assert!(of_fit(&about, &fitted, &EVENT).is_some(), "seed {seed}");
        fitted.shock.peak *= 0.5;
        assert!(of_fit(&about, &fitted, &EVENT).is_none(), "seed {seed}");
    }
}

#[test]
fn what_a_course_leaves_makes_its_numbers_less_sure() {
    for (seed, loud) in [(3, 1.0), (4, 3.0)] {
        let (about, fitted) = fitted(seed, loud);
        let course = of_fit(&about, &fitted, &EVENT);
        let course = course.unwrap_or_else(|| panic!("seed {seed}: another form"));
        let wider = course.sd[0].expect("known") / fitted.sd[0];
        // The deviation of two hundred errors is known to 5 %.
        assert!((wider / loud - 1.0).abs() < 0.25, "seed {seed}: {wider}");
    }
}

#[test]
fn what_turns_once_does_not_ring() {
    let of = |cycles: f64| {
        let mut values = vec![0.0; 1000];
        for (n, value) in values[400..500].iter_mut().enumerate() {
            *value = (TAU * cycles * (n as f64 + 0.5) / 100.0).sin();
        }
        told(&values, &(400..500), &(0..1000), None).shock.f_hz
    };
    assert_eq!(of(1.0), 0.0);
    assert!((of(4.0) - 0.04).abs() < 0.005);
}

#[test]
fn one_course_is_most_of_what_settles_and_not_of_what_sways() {
    type Wave = fn(f64) -> f64;
    let settles: Wave = |share| (-5.0 * share).exp();
    let sways: Wave = |share| {
        let waves = [(2.3, 0.4), (5.1, 2.0), (7.9, 5.0), (3.6, 1.0)];
        waves
            .map(|(f, phase)| (TAU * f * share + phase).sin())
            .iter()
            .sum()
    };
    for (seed, wave, is_most) in [(60, settles, true), (61, sways, false), (62, sways, false)] {
        let mut values = noise(seed);
        let length = EVENT.len() as f64;
        for (n, value) in values[EVENT].iter_mut().enumerate() {
            *value += 100.0 * wave(n as f64 / length);
        }
        let about = trial::about(&values);
        let fitted = fit::fit(&about).expect("a course");
        assert_eq!(
            super::is_most(&about, &fitted, &EVENT),
            is_most,
            "seed {seed}"
        );
    }
}
