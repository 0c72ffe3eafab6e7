use std::f64::consts::TAU;

use super::*;
use crate::model::Seed;
use crate::simulate::Gaussian;

const LENGTH: usize = 60_000;
const RATE_HZ: f64 = 2000.0;

/// Harmonics of `base_hz` in white noise of deviation 1, each with the gain in log-likelihood
/// given for it, `samples` lost ahead of sample `at`.
fn hum(seed: u64, base_hz: f64, harmonics: &[(f64, f64)], at: usize, samples: usize) -> Vec<f64> {
    let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let mut values: Vec<f64> = (0..LENGTH).map(|_| noise.draw()).collect();
    for (number, nats) in harmonics {
        // A^2 N / (4 sigma^2) nats.
        let amplitude = (4.0 * nats / LENGTH as f64).sqrt();
        let phase = TAU * noise.draw();
        for (index, value) in values.iter_mut().enumerate() {
            let moment = index + if index < at { 0 } else { samples };
            let turn = TAU * (number * base_hz / RATE_HZ * moment as f64).fract();
            *value += amplitude * (turn + phase).cos();
        }
    }
    values
}

/// Frequencies in cycles a sample, each off by as much as a jump splits a line.
fn rough(base_hz: f64, harmonics: &[(f64, f64)]) -> Vec<f64> {
    harmonics
        .iter()
        .flat_map(|(number, _)| {
            let cycles = number * base_hz / RATE_HZ;
            [cycles - 0.8 / LENGTH as f64, cycles + 1.1 / LENGTH as f64]
        })
        .collect()
}

fn look(values: &[f64], rough: &[f64], level: f64) -> Option<Loss> {
    search(values, rough, level, |_| true)
}

const HARMONICS: [(f64, f64); 3] = [(1.0, 200.0), (2.0, 120.0), (3.0, 80.0)];

/// Where and how much is lost in the record of a seed.
fn drawn(seed: u64) -> (usize, usize) {
    let mut random = Gaussian::new(Seed { seed, stream: 1 }, 1.0);
    let place = 0.5 + 0.25 * random.draw().tanh();
    let samples = 4 + (29.0 * random.draw().abs().fract()) as usize;
    ((place * LENGTH as f64) as usize, samples.min(26))
}

#[test]
fn a_loss_is_found_and_measured() {
    let (mut squares, mut inside, mut held) = (Vec::new(), 0, 0);
    for seed in 0..16 {
        let base_hz = if seed % 2 == 0 { 50.03 } else { 59.98 };
        let (at, samples) = drawn(seed);
        let values = hum(seed, base_hz, &HARMONICS, at, samples);
        let loss = look(&values, &rough(base_hz, &HARMONICS), 1e-4)
            .unwrap_or_else(|| panic!("seed {seed}: {samples} at {at}"));
        let truth = samples as f64;
        inside += i32::from(loss.samples_lo < truth && truth < loss.samples_hi);
        held += i32::from(loss.held_nats > 0.0);
        squares.push(((loss.index as f64 - at as f64) / loss.index_sd).powi(2));
        assert!(
            (f64::from(loss.samples) - truth).abs() <= 3.0,
            "seed {seed}"
        );
        // With the lines out, white noise of variance 1 is left: 4 sigma of its mean square.
        let mut left = values;
        loss.waves().for_each(|wave| wave.take_out(&mut left));
        let power = left.iter().map(|v| v * v).sum::<f64>() / LENGTH as f64;
        assert!(
            (power - 1.0).abs() < 4.0 * (2.0 / LENGTH as f64).sqrt(),
            "seed {seed}: {power}"
        );
    }
    // 95 % of 16: fewer than 12 have a chance of 1e-4.
    assert!(inside >= 12, "{inside} of 16");
    assert_eq!(held, 16);
    // The moment's posterior has exponential tails, kurtosis about 6: sd of a mean square
    // of 16 values is sqrt(5/16); 4 of these.
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    assert!(mean < 1.0 + 4.0 * (5.0f64 / 16.0).sqrt(), "{mean}");
}

#[test]
fn steady_lines_keep_the_level() {
    // Markov: 1/m < 0.1 in at most a tenth of the records. In 40, 4 and 4 sigma: 11.
    let mut low = 0;
    for seed in 100..140 {
        let values = hum(seed, 50.03, &HARMONICS, 0, 0);
        assert_eq!(
            look(&values, &rough(50.03, &HARMONICS), 0.1),
            None,
            "seed {seed}"
        );
        let blocks = Blocks::new(&values, BLOCKS, |_| true);
        let lines: Vec<Line> = HARMONICS
            .iter()
            .map(|(number, _)| {
                let seen = blocks.at(number * 50.03 / RATE_HZ);
                let (offset, gain) = seen.best_offset(0.0, REACH, None);
                Line { seen, offset, gain }
            })
            .collect();
        low += i32::from(Tables::new(&lines, 64).mean_ratio() > 10f64.ln());
    }
    assert!(low < 11, "{low} of 40, seeds 100..140");
}

#[test]
fn look_alikes_are_none() {
    for seed in 200..206 {
        let lines = rough(50.03, &HARMONICS);
        // The base jumps by itself, the others go on.
        let mut values = hum(seed, 50.03, &HARMONICS[..1], 30_000, 9);
        let rest = hum(seed + 1000, 50.03, &HARMONICS[1..], 0, 0);
        values.iter_mut().zip(&rest).for_each(|(v, r)| *v += r);
        assert_eq!(look(&values, &lines, 1e-3), None, "alone, seed {seed}");
        // The mains' phase wanders, a random walk of 2 radians over the record.
        let mut random = Gaussian::new(Seed { seed, stream: 3 }, 1.0);
        let mut phase = 0.0;
        let mut values = hum(seed, 50.03, &[], 0, 0);
        for (index, value) in values.iter_mut().enumerate() {
            phase += 2.0 * random.draw() / (LENGTH as f64).sqrt();
            let turn = TAU * (50.03 / RATE_HZ * index as f64).fract() + phase;
            *value += 0.2 * turn.cos() + 0.15 * (2.0 * turn).cos() + 0.1 * (3.0 * turn).cos();
        }
        assert_eq!(look(&values, &lines, 1e-3), None, "wander, seed {seed}");
        // Two hums that beat.
        let shifted = 50.03 + 1.7 * RATE_HZ / LENGTH as f64;
        let mut values = hum(seed, 50.03, &HARMONICS, 0, 0);
        let other = hum(seed + 2000, shifted, &HARMONICS, 0, 0);
        values.iter_mut().zip(&other).for_each(|(v, o)| *v += o);
        assert_eq!(look(&values, &lines, 1e-3), None, "beat, seed {seed}");
        // One line alone.
        let values = hum(seed, 50.03, &HARMONICS[..1], 30_000, 9);
        assert_eq!(look(&values, &lines[..2], 1e-3), None, "one, seed {seed}");
    }
}
