//! Terms that keep their sizes, that all swing alike, and one that swings against the others.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::*;
use crate::model::random::Gaussian;
use crate::model::random::Seed;

const LENGTH: usize = 1 << 17;
const RATE_HZ: f64 = 2000.0;
const CYCLES: f64 = 9.0;

/// White noise beside a difference of white noise whose size swings by this share.
fn axis(seed: u64, swing: f64) -> AxisState {
    let draw = |stream| {
        let mut noise = Gaussian::new(Seed { seed, stream }, 1.0);
        (0..=LENGTH).map(|_| noise.draw()).collect::<Vec<f64>>()
    };
    let (white, steps) = (draw(0), draw(1));
    let values = (0..LENGTH).map(|n| {
        let turn = TAU * CYCLES * n as f64 / LENGTH as f64;
        0.5 * white[n] + (1.0 + swing * turn.cos()) * (steps[n + 1] - steps[n])
    });
    AxisState::new(Arc::new(values.collect()), RATE_HZ, None).expect("long enough")
}

#[test]
fn steady_terms_do_not_change() {
    // Of 40 records at 1 % four or more have a probability of 1e-3.
    let alarms = (0..40).filter(|&seed| {
        change_of_terms(&axis(seed, 0.0)).is_some_and(|change| change.p_value < 0.01)
    });
    let alarms: Vec<u64> = alarms.collect();
    assert!(alarms.len() < 4, "seeds {alarms:?}");
}

#[test]
fn noise_that_is_louder_at_times_is_no_matter_of_its_colour() {
    for seed in 100..104 {
        let steady = axis(seed, 0.0);
        let louder = |(n, value): (usize, &f64)| {
            value * (1.0 + 0.2 * (TAU * CYCLES * n as f64 / LENGTH as f64).cos())
        };
        let values = steady.filled.iter().enumerate().map(louder).collect();
        let louder = AxisState::new(Arc::new(values), RATE_HZ, None).expect("long enough");
        let change = change_of_terms(&louder);
        assert!(
            change.as_ref().is_none_or(|change| change.p_value > 1e-4),
            "seed {seed}: {change:?}"
        );
    }
}

#[test]
fn a_term_that_swings_is_found_with_its_cycle() {
    for seed in 200..204 {
        let change = change_of_terms(&axis(seed, 0.2)).expect("something");
        let cycle_s = LENGTH as f64 / RATE_HZ / CYCLES;
        assert!(change.p_value < 1e-6, "seed {seed}: {change:?}");
        assert!(
            change.cyclic && change.time_s == cycle_s,
            "seed {seed}: {change:?}"
        );
    }
}

#[test]
fn what_the_record_hardly_determines_cannot_be_seen_to_change() {
    let axis = axis(300, 0.0);
    let tiles = Tiles::new(&axis, BLOCKS[BLOCKS.len() - 1]);
    // Known to a few percent, and a thousand times worse.
    for (weight, is_asked) in [(1.0, true), (1e-3, false)] {
        let scores = Scores::new(&tiles, |f_hz| weight * f_hz / RATE_HZ);
        assert_eq!(scores.change(&axis).is_some(), is_asked, "seed 300");
    }
}
