//! Noise that is steady, tones that wander, and noise that is switched.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::*;
use crate::diagnosis::explanation::Change;
use crate::diagnosis::record::envelope::Envelope;
use crate::diagnosis::trial;
use crate::model::cyclic;
use crate::model::random::Gaussian;
use crate::model::random::Seed;

const LENGTH: usize = 1 << 17;
const RATE_HZ: f64 = 2000.0;

/// White noise of deviation 1 with what `more` adds, of a sample's number and noise.
fn axis(seed: u64, more: impl Fn(usize, f64) -> f64) -> AxisState {
    let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let values = (0..LENGTH).map(|n| more(n, noise.draw())).collect();
    AxisState::new(Arc::new(values), RATE_HZ, None).expect("long enough")
}

/// A tone of this amplitude that sways by 20 Hz about 300 Hz, six times a record.
fn wandering(amplitude: f64) -> impl Fn(usize, f64) -> f64 {
    move |n, noise| {
        let at = n as f64 / LENGTH as f64;
        // The integral of 300 + 20 cos(2 pi 6 at).
        let swings = 20.0 * (TAU * 6.0 * at).sin() / (TAU * 6.0);
        let cycles = (300.0 * at + swings) * LENGTH as f64 / RATE_HZ;
        noise + amplitude * (TAU * cycles).cos()
    }
}

#[test]
fn steady_noise_is_steady() {
    // 40 records at a level of 1 %: four or more alarms have a probability of 1e-3.
    let alarms = (0..40).filter(|&seed| {
        let axis = axis(seed, |_, noise| noise);
        unsteady(&axis, 0.0..1000.0, &[], 0.01).is_some()
    });
    let alarms: Vec<u64> = alarms.collect();
    assert!(alarms.len() < 4, "seeds {alarms:?}");
}

#[test]
fn a_wandering_tone_is_found_in_its_place() {
    for seed in 100..104 {
        let found = unsteady(&axis(seed, wandering(0.5)), 0.0..1000.0, &[], 1e-4);
        let found = found.unwrap_or_else(|| panic!("seed {seed}: nothing"));
        // Groups of 15.6 Hz at most lie across its ends.
        assert!(
            found.from_hz > 260.0 && found.to_hz < 340.0,
            "seed {seed}: {found:?}"
        );
    }
}

#[test]
fn noise_that_is_switched_is_unsteady_everywhere() {
    for seed in 200..204 {
        let switched = |n: usize, noise: f64| if n % 4000 < 2000 { noise } else { 1.4 * noise };
        let found = unsteady(&axis(seed, switched), 0.0..1000.0, &[], 1e-4);
        let found = found.unwrap_or_else(|| panic!("seed {seed}: nothing"));
        assert!(
            found.to_hz - found.from_hz > 500.0,
            "seed {seed}: {found:?}"
        );
        // Powers of 1 and 1.96 by turns: relative variance 0.105.
        assert!(
            (0.05..0.2).contains(&found.variance),
            "seed {seed}: {found:?}"
        );
    }
}

#[test]
fn what_is_apart_is_not_looked_at() {
    let axis = axis(300, wandering(0.5));
    let found = unsteady(&axis, 0.0..1000.0, &[250.0..350.0], 1e-4);
    assert_eq!(found, None, "seed 300");
}

#[test]
fn fewer_tiles_than_256_are_not_judged() {
    let p_value = |tiles: usize| {
        let groups = Groups {
            size: NARROWEST,
            starts: vec![NARROWEST],
            scores: vec![0.0, 0.2 * tiles as f64],
            tiles: vec![0.0, tiles as f64],
        };
        groups.judge(&(0..1)).1
    };
    assert_eq!(p_value(255), 1.0);
    assert!(p_value(256) < 1e-20);
}

#[test]
fn only_what_lies_within_is_looked_at() {
    let axis = axis(300, |_, noise| noise);
    let seen = axis.whitened();
    let groups = Groups::new(&axis, &seen, NARROWEST, &(100.0..200.0), &[]);
    let end = groups.starts.last().map(|start| start + NARROWEST);
    let [from_hz, to_hz] =
        [groups.starts[0], end.expect("a group")].map(|k| seen.transform.frequency(k));
    let group_hz = seen.transform.frequency(NARROWEST);
    assert!((100.0..100.0 + group_hz).contains(&from_hz), "{from_hz}");
    assert!((200.0 - group_hz..=200.0).contains(&to_hz), "{to_hz}");
}

#[test]
fn what_departs_beside_a_band_belongs_to_it() {
    // Of 256 tiles each, by so many deviations of their sum.
    let by = [0.0, 4.0, 20.0, 4.0, 0.0, 4.0];
    let scores = by.iter().scan(0.0, |sum, z| {
        *sum += z * (256.0_f64 / 48.0).sqrt();
        Some(*sum)
    });
    let groups = Groups {
        size: NARROWEST,
        starts: (1..=by.len()).map(|n| n * NARROWEST).collect(),
        scores: std::iter::once(0.0).chain(scores).collect(),
        tiles: (0..=by.len()).map(|n| 256.0 * n as f64).collect(),
    };
    let mut best = None;
    groups.search(&mut best);
    let ordinates = best.expect("a band").ordinates;
    assert_eq!(ordinates, 2 * NARROWEST..5 * NARROWEST);
}

#[test]
fn noise_that_swings_as_is_known_is_steady() {
    let swing = Envelope {
        depth: 0.5,
        period: 4000.0,
        phase_rad: 0.0,
    };
    let mut axis = axis(400, |n, noise| swing.factor(n) * noise);
    let is_unsteady = |axis: &AxisState| unsteady(axis, 0.0..1000.0, &[], 1e-4).is_some();
    assert!(is_unsteady(&axis), "seed 400");
    trial::take_in(&mut axis, cyclic::KIND, Change::Strength(swing));
    assert!(!is_unsteady(&axis), "seed 400: known");
}
