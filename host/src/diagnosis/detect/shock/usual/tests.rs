//! How strong noise is said to be, and how rare a height.

use std::f64::consts::TAU;

use statrs::distribution::{ContinuousCDF, Normal};

use super::*;
use crate::diagnosis::detect::trial::noise;
use crate::diagnosis::trial::{markov, numbers};

/// Windows of 64 samples of some values.
fn of(values: &[f64], least: f64) -> Usual {
    let windows = Windows::new(64);
    let starts: Vec<usize> = windows.starts(&(0..values.len())).collect();
    Usual::new(windows, values, 1.0, &starts, least).expect("enough windows")
}

fn taper_square() -> f64 {
    Windows::new(64).taper.iter().map(|one| one * one).sum()
}

#[test]
fn fewer_than_24_windows_say_nothing() {
    let values = noise(1);
    let of = |count: usize| {
        let starts: Vec<usize> = (0..count).map(|n| 64 * n).collect();
        Usual::new(Windows::new(64), &values, 1.0, &starts, 0.0).is_some()
    };
    assert!(of(24) && !of(23), "seed 1");
}

#[test]
fn no_frequency_has_less_than_rounding_makes() {
    let usual = of(&[0.0; 4000], 0.25);
    let least = 0.25 * taper_square();
    assert!(usual.power.iter().all(|one| *one >= least));
}

#[test]
fn what_a_filter_shuts_out_is_no_less_than_30_db_down() {
    let mut normal = numbers(2, 0);
    let mut values = vec![0.0; 4000];
    // Tones up to a quarter of the rate, as close as a window distinguishes them in the record.
    for number in 1..500 {
        let (cycles, turn) = (0.0005 * f64::from(number), normal.draw());
        for (n, value) in values.iter_mut().enumerate() {
            *value += (TAU * (cycles * n as f64 + turn)).cos();
        }
    }
    let usual = of(&values, 0.0);
    let (passed, last) = (usual.power[12], usual.power[30]);
    // Medians of as many powers are known to a tenth.
    let over = last / passed / 1e-3;
    assert!((0.5..2.0).contains(&over), "seed 2: {over}");
}

#[test]
fn a_frequency_that_lies_below_its_neighbours_is_as_strong_as_they_are() {
    let mut usual = of(&noise(3), 0.0);
    usual.power.clear();
    usual.rests_on.clear();
    let (rows, bins) = (24, usual.windows.bins());
    let power = |cell: usize| if cell % bins == 20 { 0.01 } else { 1.0 };
    let seen: Vec<f64> = (0..rows * bins).map(power).collect();
    usual.settle_powers(&seen, rows, 2, 0.0);
    assert_eq!(usual.power[20], usual.power[19]);
}

#[test]
fn a_power_is_as_rare_as_beside_a_mean_of_so_few() {
    const DRAWN: u32 = 40_000;
    let mut usual = of(&noise(4), 0.0);
    usual.rests_on[5] = 4.0;
    let mut normal = numbers(4, 1);
    // An exponential number of mean 1 is half the square of two normal ones.
    let mut exponential = || 0.5 * (normal.draw().powi(2) + normal.draw().powi(2));
    let exceeds = (0..DRAWN).filter(|_| {
        let mean = (0..4).map(|_| exponential()).sum::<f64>() / 4.0;
        exponential() > 4.0 * mean
    });
    let share = exceeds.count() as f64 / f64::from(DRAWN);
    let expected = (-usual.surprise(5, 4.0)).exp();
    let sd = (expected / f64::from(DRAWN)).sqrt();
    assert!(
        (share - expected).abs() < 5.0 * sd,
        "seed 4: {share}, {expected}"
    );
}

#[test]
fn where_windows_are_too_few_heights_are_as_rare_as_elsewhere() {
    let mut values = noise(9);
    values[3000..3064]
        .iter_mut()
        .for_each(|value| *value *= 5.0);
    let starts: Vec<usize> = Windows::new(64).starts(&(0..4000)).collect();
    // Heights beyond 2 fall ten times as slowly.
    let slow: Vec<f64> = (0..2000)
        .map(|n| (4.0 + 20.0 * f64::ln(2000.0 / f64::from(n + 1))).sqrt())
        .collect();
    let elsewhere = Rare::of(slow).expect("enough");
    let z = |elsewhere| {
        let high = of(&values, 0.0).heights(&values, &starts, 4.0, elsewhere);
        high.iter().map(|(_, one)| one.z).fold(0.0, f64::max)
    };
    let (plain, rare) = (z(None), z(Some(elsewhere)));
    assert!(plain > 6.0 && rare < 0.9 * plain, "seed 9: {plain}, {rare}");
}

/// Noise whose strength wanders within some samples, its logarithm by `deviation`.
fn wandering(seed: u64, samples: f64, deviation: f64) -> Vec<f64> {
    let mut strength = markov(seed, samples);
    let mut values = noise(seed);
    values
        .iter_mut()
        .for_each(|value| *value *= (deviation * strength()).exp());
    values
}

#[test]
fn where_strength_wanders_hardly_more_stands_out_than_by_a_normal_law() {
    const Z: f64 = 3.0;
    for seed in 10..13 {
        let values = wandering(seed, 30.0, 0.4);
        let usual = of(&values, 0.0);
        let starts: Vec<usize> = usual.windows.starts(&(0..values.len())).collect();
        let mut memory = (usual.windows.scratch(), Vec::new());
        let mut height = |start: usize| usual.height(&values, start, 0.0, &mut memory).z;
        let count = starts.iter().filter(|start| height(**start) > Z).count();
        // Each ordinate is judged, and the sum of each group.
        let trials = usual.windows.bins() + usual.groups.len();
        let by_chance = trials as f64 * Normal::standard().sf(Z) * starts.len() as f64;
        // Some sixty of a thousand windows, known to a seventh; with the tails of normal noise five times as many would.
        assert!(
            (count as f64) < 3.0 * by_chance,
            "seed {seed}: {count} of {by_chance}"
        );
    }
}
