//! Levels that switch, step, settle or follow the temperature.

use super::{Alone, RATE_HZ, near};

#[test]
fn a_telegraph_has_two_levels_and_poisson_switches() {
    for seed in 1..6 {
        let alone = Alone::new("telegraph", 1.0, seed);
        let (height, dwell_s) = (alone.parameter("height"), alone.parameter("dwell_s"));
        let switches = alone
            .samples
            .windows(2)
            .filter(|pair| (pair[1] - pair[0]).abs() > 0.5 * height)
            .count() as f64;
        let expected = alone.duration_s() / dwell_s;
        near(switches, expected, 5.0 * expected.sqrt(), seed);
        let high = alone.samples.iter().filter(|x| **x > 0.0).count() as f64;
        let share = high / alone.samples.len() as f64;
        // Dwells of both sides are exponential: the share varies by sqrt(1 / (2 switches)).
        near(share, 0.5, 5.0 * (0.5 / expected).sqrt(), seed);
        for sample in &alone.samples {
            near(sample.abs(), 0.5 * height, 1e-3 * height, seed);
        }
    }
}

#[test]
fn steps_stay() {
    for seed in 1..6 {
        let alone = Alone::new("steps", 1.0, seed);
        let mut level = alone.samples[0];
        let mut count = 0;
        while let Some(time_s) = alone.truth().parameter(&format!("time_s_{}", count + 1)) {
            count += 1;
            let at = (time_s * RATE_HZ).ceil() as usize;
            level += alone.parameter(&format!("height_{count}"));
            near(alone.samples[at + 1], level, 1e-5, seed);
            near(alone.samples[at + 5000], level, 1e-5, seed);
        }
        let last = alone.samples[alone.samples.len() - 1];
        near(last, level, 1e-5, seed);
        assert!((1..=3).contains(&count), "seed {seed}");
    }
}

#[test]
fn a_warmup_settles() {
    let alone = Alone::new("warmup", 1.0, 2);
    let (amplitude, time_s) = (alone.parameter("amplitude"), alone.parameter("time_s"));
    let at = |t_s: f64| alone.samples[(t_s * RATE_HZ) as usize];
    let fall = at(0.0) - at(time_s);
    near(fall, amplitude * (1.0 - (-1.0_f64).exp()), 1e-6, 2);
    let more = at(time_s) - at(3.0 * time_s);
    let expected = amplitude * ((-1.0_f64).exp() - (-3.0_f64).exp());
    near(more, expected, 1e-6, 2);
}

/// `lag y' = gain T - y`, over the record: the lag as the slope of (gain T - y) on y'. The
/// thermometer's own noise is averaged over a second.
#[test]
fn the_thermal_level_follows_late() {
    for seed in 1..4 {
        let alone = Alone::new("thermal", 1.0, seed);
        let (gain, lag_s) = (alone.parameter("gain"), alone.parameter("lag_s"));
        let temperature = alone.effect.temperature().expect("a column");
        let second = RATE_HZ as usize;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let level: Vec<f64> = alone.samples.chunks_exact(second).map(mean).collect();
        let air: Vec<f64> = temperature.chunks_exact(second).map(mean).collect();
        let (mut slope, mut weight) = (0.0, 0.0);
        for i in 1..level.len() - 1 {
            let rise = 0.5 * (level[i + 1] - level[i - 1]);
            slope += rise * (gain * (air[i] - 25.0) - level[i]);
            weight += rise * rise;
        }
        near(slope / weight, lag_s, 0.1 * lag_s + 0.2, seed);
    }
}
