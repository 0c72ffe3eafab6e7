//! How many shocks are told, and of what.

use super::*;
use crate::model::random::{Gaussian, Seed};

/// How many are told of a record with bumps of these sizes, evenly over it.
fn count(seed: u64, peaks: &[f64]) -> usize {
    let mut values = noise(seed);
    let places = spread(values.len(), peaks.len());
    let bumps: Vec<Shock> = places
        .zip(peaks)
        .map(|(place, peak)| bump(place as f64 / RATE_HZ, *peak, 0.3))
        .collect();
    add(&mut values, &bumps);
    told(values).len()
}

#[test]
fn of_many_shocks_those_near_the_plainest_are_told() {
    let mut peaks = [20.0; 16];
    peaks[5] = 1e4;
    peaks[11] = 9e3;
    assert_eq!(count(72, &peaks), 2, "seed 72");
    assert_eq!(count(72, &peaks[..8]), 8, "seed 72: few");
}

#[test]
fn what_lasts_for_a_sixth_of_the_record_is_no_event() {
    let with = |decay_s: f64| {
        let mut values = noise(73);
        let length_s = values.len() as f64 / RATE_HZ;
        for part in [0.2, 0.5, 0.8] {
            let long = Shock {
                decay_s: decay_s * length_s,
                ..ringing(part * length_s, 40.0)
            };
            add(&mut values, &[long]);
        }
        told(values).len()
    };
    assert_eq!(with(0.002), 3, "seed 73");
    assert_eq!(with(0.02), 0, "seed 73");
}

#[test]
fn what_lasting_strength_foretells_is_no_shock() {
    // Noise whose variance feeds on its own squares.
    for seed in 75..79 {
        let mut normal = Gaussian::new(Seed { seed, stream: 4 }, 1.0);
        let mut variance = 1.0_f64;
        let next = |_| {
            let value = variance.sqrt() * normal.draw();
            variance = 0.03 + 0.15 * value * value + 0.82 * variance;
            value
        };
        let found = told((0..70_001).map(next).collect());
        assert!(found.is_empty(), "seed {seed}: {found:?}");
    }
}

#[test]
fn where_something_happens_most_of_the_time_what_stands_out_of_that_is_told() {
    for seed in 80..82 {
        let mut values = noise(seed);
        let length_s = values.len() as f64 / RATE_HZ;
        let long = [0.2, 0.5, 0.8].map(|part| Shock {
            decay_s: 0.02 * length_s,
            ..ringing(part * length_s, 3.0)
        });
        add(&mut values, &long);
        assert_eq!(told(values.clone()), [], "seed {seed}");
        let knock = Shock {
            decay_s: 0.05,
            ..ringing(0.33 * length_s, 1e4)
        };
        add(&mut values, &[knock]);
        let found = told(values);
        let is_it = |one: &Shock| (one.time_s - knock.time_s).abs() < 0.02;
        assert!(
            found.len() == 1 && is_it(&found[0]),
            "seed {seed}: {found:?}"
        );
    }
}

#[test]
fn of_more_than_forty_shocks_those_are_told_that_stand_out_further() {
    // Some short, some long, so that neither are many enough to say how rare such heights are.
    let count = |seed: u64, of_each: usize| {
        let mut normal = Gaussian::new(Seed { seed, stream: 4 }, 1.0);
        let mut values: Vec<f64> = (0..200_001).map(|_| normal.draw()).collect();
        let places = spread(values.len(), 2 * of_each);
        let knocks: Vec<Shock> = places
            .zip([0.05, 1.0].into_iter().cycle())
            .map(|(place, decay_s)| Shock {
                decay_s,
                ..ringing(place as f64 / RATE_HZ, 30.0)
            })
            .collect();
        add(&mut values, &knocks);
        told(values).len()
    };
    for seed in 84..86 {
        assert_eq!(count(seed, 19), 38, "seed {seed}");
        // The long ones: all their windows together stand out more than three times as far.
        assert_eq!(count(seed, 22), 22, "seed {seed}");
        // Too many of these as well.
        assert_eq!(count(seed, 45), 0, "seed {seed}");
    }
}
