//! What stands out and is no shock, by the one rule that says so.

use super::*;
use crate::diagnosis::detect::shock::event::{Event, What};
use crate::diagnosis::detect::shock::quiet::Quiet;
use crate::diagnosis::detect::shock::scan::Scan;
use crate::diagnosis::detect::shock::stretch::Stretch;
use crate::diagnosis::record::runs::without;
use crate::model::burst;
use crate::model::kind::Kind;
use crate::numeric::taper::hann;

/// Where something is.
const PLACE: usize = 9000;

/// Kinds of what is told of a record.
fn kinds(values: Vec<f64>) -> Vec<Kind> {
    trial::kinds(&Trial::new(values).ask(&DETECTOR))
}

/// Adds a tone to some samples of a record.
fn add_tone(values: &mut [f64], amplitude: f64, cycles: f64, turns: f64) {
    let samples = values.iter_mut().enumerate();
    samples.for_each(|(n, one)| *one += amplitude * (2.0 * PI * (cycles * n as f64 + turns)).cos());
}

#[test]
fn single_samples_however_large_beside_missing_ones_are_no_shocks() {
    for seed in 140..142 {
        let mut values = noise(seed);
        let len = values.len();
        spread(len, 20).for_each(|place| values[place] += 1e5);
        values
            .iter_mut()
            .step_by(23)
            .for_each(|one| *one = f64::NAN);
        let found = kinds(values);
        assert!(found.is_empty(), "seed {seed}: {found:?}");
    }
}

#[test]
fn a_line_whose_phase_jumps_is_no_shock() {
    for seed in 142..144 {
        let mut values = noise(seed);
        // Nearly half a turn is gone with samples that are lost.
        add_tone(&mut values[..PLACE], 30.0, 0.123, 0.0);
        add_tone(
            &mut values[PLACE..],
            30.0,
            0.123,
            0.123 * PLACE as f64 + 0.45,
        );
        let found = kinds(values);
        assert!(found.is_empty(), "seed {seed}: {found:?}");
    }
}

#[test]
fn a_jump_behind_a_filter_that_rings_is_no_shock() {
    /// Half of the filter's length: as long as a converter's answers.
    const HALF: usize = 27;
    for seed in 144..146 {
        let mut values = noise(seed);
        values[PLACE..].iter_mut().for_each(|one| *one += 1e3);
        let aside = |n: usize| n as f64 - HALF as f64;
        let weight = |n: usize| {
            let sinc = if n == HALF {
                0.9
            } else {
                (0.9 * PI * aside(n)).sin() / (PI * aside(n))
            };
            sinc * hann(n as f64 + 1.0, 2.0 * HALF as f64 + 2.0)
        };
        let weights: Vec<f64> = (0..=2 * HALF).map(weight).collect();
        let passed = values.windows(weights.len()).map(|near| {
            let both = near.iter().zip(&weights);
            both.map(|(value, weight)| value * weight).sum::<f64>()
        });
        let found = kinds(passed.collect());
        assert!(found.is_empty(), "seed {seed}: {found:?}");
    }
}

#[test]
fn a_jump_that_shows_in_long_windows_alone_is_no_shock() {
    for seed in 146..149 {
        let mut values = noise(seed);
        values[PLACE..].iter_mut().for_each(|one| *one += 3.0);
        let found = kinds(values);
        assert!(found.is_empty(), "seed {seed}: {found:?}");
    }
}

#[test]
fn a_stretch_that_is_hardly_louder_is_a_burst() {
    for seed in 149..152 {
        let mut values = noise(seed);
        values[PLACE..PLACE + 800]
            .iter_mut()
            .for_each(|one| *one *= 1.6);
        assert_eq!(kinds(values), [burst::KIND], "seed {seed}");
    }
}

#[test]
fn a_tone_for_a_while_is_no_burst() {
    for seed in 152..154 {
        let mut values = noise(seed);
        add_tone(&mut values[PLACE..PLACE + 2000], 5.0, 0.073, 0.0);
        let found = kinds(values);
        assert!(!found.contains(&burst::KIND), "seed {seed}: {found:?}");
    }
}

#[test]
fn two_knocks_close_together_are_no_burst() {
    for seed in 160..162 {
        for apart_s in [3.5, 5.0] {
            let mut values = noise(seed);
            let both = [0.0, apart_s].map(|later_s| ringing(90.0 + later_s, 30.0));
            add(&mut values, &both);
            let found = told(values);
            assert_eq!(found.len(), 2, "seed {seed}, {apart_s}: {found:?}");
        }
    }
}

#[test]
fn what_the_record_begins_with_is_no_bump() {
    for seed in 154..156 {
        let with = |time_s: f64| {
            let mut values = noise(seed);
            add(&mut values, &[bump(time_s, 40.0, 0.6)]);
            told(values).len()
        };
        assert_eq!(with(0.0), 0, "seed {seed}");
        assert_eq!(with(1.0), 1, "seed {seed}");
    }
}

#[test]
fn what_does_not_stand_out_of_the_noise_beside_it_is_nothing() {
    for seed in 156..159 {
        let is_shock = |factor: f64| {
            let mut values = noise(seed);
            values[PLACE - 1000..PLACE + 1000]
                .iter_mut()
                .for_each(|one| *one *= factor);
            add(&mut values, &[bump(PLACE as f64 / RATE_HZ, 8.0, 0.3)]);
            let mut scan = Scan::new(&values, &values).expect("long enough");
            scan.stretches(trial::LEVEL, RATE_HZ);
            // As if only the bump stood out of the record.
            let stretch = Stretch {
                samples: PLACE..PLACE + 32,
                z: 15.0,
                frequency: 0.03,
                window: 64,
                longest: 32,
                nats: 112.0,
            };
            let holes = [stretch.samples.clone()];
            let quiet = Quiet {
                runs: without(scan.runs(), &holes),
                whole: without(scan.whole_runs(), &holes),
            };
            let what = Event::new(&scan, &stretch, &quiet).what();
            matches!(what, What::Shock(_))
        };
        assert!(is_shock(1.0), "seed {seed}");
        assert!(!is_shock(6.0), "seed {seed}");
    }
}

#[test]
fn single_samples_that_come_close_by_chance_are_no_event() {
    for (seed, apart) in [(160, [0, 23, 47, 70]), (161, [0, 90, 130, 171])] {
        let mut values = noise(seed);
        for (at, size) in apart.into_iter().zip([40.0, -25.0, 60.0, 30.0]) {
            values[9000 + at] += size;
        }
        assert!(Trial::new(values).ask(&DETECTOR).is_empty(), "seed {seed}");
    }
}
