//! What happens now and then: large samples, shocks, and noise that is louder for a while.

use std::f64::consts::TAU;

use super::{Alone, RATE_HZ, near, variance};

#[test]
fn outliers_are_rare_and_of_their_size() {
    for seed in 1..6 {
        let alone = Alone::new("outliers", 1.0, seed);
        let (rate_hz, size) = (alone.parameter("rate_hz"), alone.parameter("size"));
        let off: Vec<f64> = alone
            .samples
            .iter()
            .map(|x| x - alone.samples[0])
            .filter(|x| x.abs() > 1e-4 * size)
            .collect();
        let expected = rate_hz * alone.duration_s();
        near(off.len() as f64, expected, 5.0 * expected.sqrt(), seed);
        let mean_square = off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64;
        let tolerance = 5.0 * (2.0 / off.len() as f64).sqrt() * size.powi(2);
        near(mean_square, size.powi(2), tolerance, seed);
    }
}

#[test]
fn a_burst_is_louder_by_its_factor() {
    for seed in 1..4 {
        let alone = Alone::within("burst", 5.0, 1e-3, seed);
        let at = |name: &str| (alone.parameter(name) * RATE_HZ) as usize;
        let inside = &alone.samples[at("from_s") + 1..at("to_s")];
        let before = &alone.samples[..at("from_s")];
        let ratio = variance(inside) / variance(before);
        let expected = alone.parameter("factor").powi(2);
        let relative = (2.0 / inside.len() as f64 + 2.0 / before.len() as f64).sqrt();
        near(ratio, expected, 5.0 * relative * expected, seed);
    }
}

#[test]
fn cyclic_noise_swings_as_a_cosine() {
    for seed in 1..4 {
        let alone = Alone::within("cyclic", 4.0, 1e-3, seed);
        let (depth, period_s) = (alone.parameter("depth"), alone.parameter("period_s"));
        let phase_rad = alone.parameter("phase_rad");
        let swing = |t_s: f64| 1.0 + depth * (TAU * t_s / period_s + phase_rad).cos();
        // Powers in four parts of a cycle, over those that the cosine says.
        let (mut powers, mut expected, mut counts) = ([0.0; 4], [0.0; 4], [0.0_f64; 4]);
        for (i, sample) in alone.samples.iter().enumerate() {
            let t_s = i as f64 / RATE_HZ;
            let part = (4.0 * (t_s / period_s).fract()) as usize;
            powers[part] += sample * sample;
            expected[part] += swing(t_s).powi(2) * 1e-6 * RATE_HZ;
            counts[part] += 1.0;
        }
        for part in 0..4 {
            // The fourth powers of the cosine are at most three halves of the squares' square, five sigma.
            let relative = (2.0 * 1.5 / counts[part]).sqrt();
            near(powers[part] / expected[part], 1.0, 5.0 * relative, seed);
        }
    }
}

#[test]
fn shocks_have_their_height_and_their_energy() {
    for seed in 1..9 {
        // So plain that the noise is a millionth of it.
        let alone = Alone::new("shock", 1e6, seed);
        let truth = alone.truth();
        let (mut energy, mut highest, mut count) = (0.0, 0.0, 0);
        while let Some(peak) = truth.parameter(&format!("peak_{}", count + 1)) {
            count += 1;
            let of = |name: &str| truth.parameter(&format!("{name}_{count}"));
            highest = f64::max(highest, peak.abs());
            energy += peak
                * peak
                * match (of("f_hz"), of("decay_s"), of("duration_s")) {
                    (Some(f_hz), Some(decay_s), None) => {
                        // The integral of e^(-2t/T) sin^2 wt, over the square of its highest point, with a = wT:
                        // T a^2 / (4 (1 + a^2)) and e^(-2 atan(a) / a) a^2 / (1 + a^2).
                        let a = TAU * f_hz * decay_s;
                        0.25 * decay_s * (2.0 * a.atan() / a).exp()
                    }
                    (None, None, Some(length_s)) => 0.5 * length_s,
                    other => panic!("seed {seed}: {other:?}"),
                };
        }
        assert!((1..=4).contains(&count), "seed {seed}");
        let largest = alone
            .samples
            .iter()
            .fold(0.0, |most: f64, one| most.max(one.abs()));
        assert!(
            largest < 1.0001 * highest,
            "seed {seed}: {largest} of {highest}"
        );
        let sum = alone.samples.iter().map(|one| one * one).sum::<f64>() / RATE_HZ;
        // What ends within a noise of 1e-6 of it lies a record's tail below; sums of twenty samples or more a decay
        // are integrals to some percent, for the first sample may come half a period late.
        near(sum / energy, 1.0, 0.1, seed);
    }
}
