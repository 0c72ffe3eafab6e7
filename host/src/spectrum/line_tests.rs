//! The line search by simulation: level, reach, amplitude, masking, gaps.

use super::record_lines::{Line, search};
use rand_distr::{Distribution, StandardNormal, Uniform};
use std::f64::consts::PI;

/// White noise of unit variance.
pub(super) fn white(seed: u64, len: usize) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64::new(u128::from(seed), 3);
    (0..len).map(|_| StandardNormal.sample(&mut rng)).collect()
}

pub(super) fn add_tone(record: &mut [f64], amplitude: f64, cycles: f64, phase: f64) {
    for (n, x) in record.iter_mut().enumerate() {
        *x += amplitude * (2.0 * PI * (cycles * n as f64).fract() + phase).cos();
    }
}

/// Amplitude in unit white noise that an ideal search of the whole record finds half of the time
/// at `level`: `A^2 N / 4` is half below the threshold `z` of Rice's formula
/// (a non-central chi-squared law of two degrees of freedom has its median 1/2 above).
pub(super) fn ideal_amplitude(len: usize, level: f64) -> f64 {
    let mut z = 15.0_f64;
    for _ in 0..30 {
        z = (0.5 * len as f64 / level).ln() + 0.5 * (PI * z / 3.0).ln();
    }
    (4.0 * (z - 0.5) / len as f64).sqrt()
}

/// Trials in which a line at a random frequency was found, and those with any other line.
fn trials(
    count: u64,
    len: usize,
    amplitude: f64,
    resolution: f64,
    find: impl Fn(&[f64]) -> Vec<Line>,
) -> (u64, u64) {
    let (mut found, mut false_alarms) = (0, 0);
    for seed in 0..count {
        let mut rng = rand_pcg::Pcg64::new(u128::from(seed), 17);
        let mut uniform = |high: f64| Uniform::new(0.0, high).unwrap().sample(&mut rng);
        let (cycles, phase) = (0.05 + uniform(0.4), uniform(2.0 * PI));
        let mut record = white(seed, len);
        add_tone(&mut record, amplitude, cycles, phase);
        let lines = find(&record);
        let near = |line: &Line| (line.frequency_hz - cycles).abs() < 3.0 * resolution;
        found += u64::from(lines.iter().any(near));
        false_alarms += u64::from(lines.iter().any(|line| !near(line)));
    }
    (found, false_alarms)
}

#[test]
fn whole_record_search_keeps_level_and_reach() {
    // The shortest that is searched, and one of no round number.
    for len in [1 << 13, 40_000] {
        let count = 200;
        let amplitude = 1.05 * ideal_amplitude(len, 0.05);
        let (found, alarms) = trials(count, len, amplitude, 1.0 / len as f64, |record| {
            search(record, 1.0, 0.05).unwrap()
        });
        assert!(found >= 79, "seeds 0..200, {len}: {found} found");
        assert!(alarms <= 19, "seeds 0..200, {len}: {alarms} false alarms");
    }
}

#[test]
fn amplitude_and_frequency_of_clear_lines() {
    let mut record = white(77, 300_000);
    let tones = [
        (0.051_234, 0.02),
        (0.2, 3.0),
        (0.200_3, 0.06),
        (0.412_345_6, 0.03),
    ];
    for (cycles, amplitude) in tones {
        add_tone(&mut record, amplitude, cycles, 1.0);
    }
    // A wander that must not hide or feign anything, and a gap.
    for (n, x) in record.iter_mut().enumerate() {
        *x += 1e5 + 40.0 * (n as f64 / 120_000.0).powi(2);
        if (100_000..100_700).contains(&n) {
            *x = f64::NAN;
        }
    }
    let whole = search(&record[..], 1.0, 0.01).unwrap();
    assert_eq!(whole.len(), tones.len(), "seed 77: {whole:?}");
    for (line, (cycles, amplitude)) in whole.iter().zip(tones) {
        let sigma = line.frequency_sd_hz;
        // The ends' taper costs a few percent of the bound, the gap leaves some too.
        assert!(
            (line.frequency_hz - cycles).abs() < 5.0 * sigma + 1e-8,
            "seed 77: {line:?}"
        );
        // Amplitudes scatter by sqrt(2 / N); the gap takes 0.25 %.
        let allowed = 5.0 * (2.0 / 300_000.0_f64).sqrt() + 0.005 * amplitude;
        assert!(
            (line.amplitude - amplitude).abs() < allowed,
            "seed 77: {line:?}"
        );
    }
}

#[test]
fn short_and_empty_records_have_no_lines() {
    for record in [
        vec![],
        vec![1.0; 100],
        vec![f64::NAN; 40_000],
        vec![2.0; 40_000],
    ] {
        assert!(search(&record[..], 1.0, 0.05).unwrap().is_empty());
    }
}
