//! Laws of noise: its correlation, its spectrum, and what axes share of it.

use std::f64::consts::{PI, TAU};

use super::{Alone, RATE_HZ, band, correlation, near, variance};

/// Sampling errors of a correlation by Bartlett: at most `sqrt(2 time / T)` of the variance.
#[test]
fn markov_noise_forgets_exponentially() {
    for seed in 1..6 {
        let alone = Alone::new("markov", 1.0, seed);
        let (amplitude, time_s) = (alone.parameter("amplitude"), alone.parameter("time_s"));
        let tolerance = 5.0 * (2.0 * time_s / alone.duration_s()).sqrt() * amplitude.powi(2);
        for times in [0.0, 0.5, 1.0, 2.0] {
            let lag = (times * time_s * RATE_HZ).round();
            let expected = amplitude.powi(2) * (-lag / (time_s * RATE_HZ)).exp();
            // The synthesis starts at zero: its level is the process' own, up to one draw, which
            // the mean takes out.
            let mean = alone.samples.iter().sum::<f64>() / alone.samples.len() as f64;
            let centred: Vec<f64> = alone.samples.iter().map(|x| x - mean).collect();
            near(
                correlation(&centred, lag as usize),
                expected,
                tolerance,
                seed,
            );
        }
    }
}

#[test]
fn a_resonance_rings_and_forgets() {
    for seed in 1..6 {
        let alone = Alone::new("resonance", 1.0, seed);
        let (f_hz, width_hz) = (alone.parameter("f_hz"), alone.parameter("width_hz"));
        let power = alone.parameter("amplitude").powi(2);
        let time_s = 1.0 / (PI * width_hz);
        let tolerance = 5.0 * (2.0 * time_s / alone.duration_s()).sqrt() * power;
        let mean = alone.samples.iter().sum::<f64>() / alone.samples.len() as f64;
        let centred: Vec<f64> = alone.samples.iter().map(|x| x - mean).collect();
        for periods in [0.0, 0.5, 1.0, 3.0] {
            let lag = (periods * RATE_HZ / f_hz).round();
            let t_s = lag / RATE_HZ;
            let expected = power * (-t_s / time_s).exp() * (TAU * f_hz * t_s).cos();
            near(
                correlation(&centred, lag as usize),
                expected,
                tolerance,
                seed,
            );
        }
    }
}

/// The level far above the corner against that far below, each over 400 ordinates: 5 % each.
#[test]
fn a_rolloff_halves_the_power_at_its_corner() {
    let alone = Alone::within("rolloff", 4.0, 1.0, 1);
    let corner_hz = alone.parameter("corner_hz");
    near(corner_hz, 500.0, 1e-9, 1);
    for (f_hz, expected) in [(50.0, 1.0 / 1.01), (500.0, 0.5), (900.0, 1.0 / 4.24)] {
        let found = band(&alone.samples, f_hz, 400);
        near(found, expected, 5.0 * expected / 400_f64.sqrt(), 1);
    }
}

/// A mean of two samples has the power cos^2 (w / 2); 400 ordinates each: 5 %.
#[test]
fn averaging_takes_what_changes_sign_from_sample_to_sample() {
    let alone = Alone::within("averaging", 3.0, 1.0, 1);
    near(alone.parameter("duration_s"), 2.0 / RATE_HZ, 1e-12, 1);
    for f_hz in [50.0, 500.0, 900.0] {
        let expected = (PI * f_hz / RATE_HZ).cos().powi(2);
        let found = band(&alone.samples, f_hz, 400);
        near(found, expected, 5.0 * expected / 400_f64.sqrt(), 1);
    }
}

/// Two bands a decade apart, 300 ordinates each: 6 % each.
#[test]
fn a_powerlaw_has_its_slope() {
    for seed in 1..4 {
        let alone = Alone::new("powerlaw", 1.0, seed);
        let exponent = alone.parameter("exponent");
        let (low, high) = (
            band(&alone.samples, 40.0, 300),
            band(&alone.samples, 400.0, 300),
        );
        // Centres of the bands, 300 ordinates of 0.0076 Hz wide.
        let expected = -exponent * (401.1_f64 / 41.1).ln();
        near(
            (high / low).ln(),
            expected,
            5.0 * (2.0 / 300_f64).sqrt(),
            seed,
        );
        let density = alone.parameter("density_1hz");
        let expected = density * 41.1_f64.powf(-exponent);
        near(low, expected, 5.0 * expected / 300_f64.sqrt(), seed);
    }
}

#[test]
fn common_noise_is_shared_by_its_gains() {
    let alone = Alone::new("common_mode", 1.0, 1);
    let first = &alone.samples;
    let power = variance(first);
    for (axis, name) in [(1, "gain_2"), (2, "gain_3")] {
        let (other, _) = alone.axis(axis);
        let product: f64 = first.iter().zip(&other).map(|(a, b)| a * b).sum();
        let gain = product / first.len() as f64 / power;
        near(gain, alone.parameter(name), 1e-4, 1);
    }
}
