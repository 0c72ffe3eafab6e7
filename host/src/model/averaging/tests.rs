//! The law of means, and that they follow it.

use super::*;
use crate::model::random::Gaussian;
use crate::model::trial;

#[test]
fn a_mean_over_nearly_whole_samples_is_meant_to_be_over_these() {
    assert_eq!(Entry.meant(&[15.03 / 50.0], 50.0), Some(vec![15.0 / 50.0]));
    assert_eq!(Entry.meant(&[15.4 / 50.0], 50.0), None);
}

#[test]
fn the_response_is_that_of_the_weights() {
    for n in [1.0, 1.3, 2.0, 5.0, 7.75, 24.0] {
        let law = Averaging {
            duration_s: n / 50.0,
            times: 1,
            place: Place::Behind,
        };
        let (whole, rest) = (n as usize, n.fract());
        let weights = std::iter::repeat_n(1.0, whole).chain([rest]);
        for f_hz in (0..50).map(|step| 0.5 * f64::from(step)) {
            let turn = 2.0 * PI * f_hz / 50.0;
            let (mut cosine, mut sine) = (0.0, 0.0);
            for (lag, weight) in (0_u32..).zip(weights.clone()) {
                cosine += weight * (f64::from(lag) * turn).cos();
                sine += weight * (f64::from(lag) * turn).sin();
            }
            let exact = (cosine * cosine + sine * sine) / (n * n);
            let off = (law.power(f_hz, 50.0) - exact).abs();
            // But for the zeros, which have a floor below all lobes.
            let lobes = (n * (0.5 * turn).sin()).powi(-2).min(1.0);
            assert!(
                off < 1e-9 + DEEPEST * lobes,
                "{n} samples, {f_hz} Hz: {off}"
            );
        }
    }
}

#[test]
fn within_a_converter_images_fold_down() {
    for (n, times) in [(1.0, 3), (0.7, 2), (5.15, 2), (4.0, 3)] {
        let law = Averaging::of(&[n / 50.0, f64::from(times)]);
        for f_hz in (0..50).map(|step| 0.5 * f64::from(step) + 0.01) {
            let image = |j: i32| {
                let x = PI * n * (f_hz / 50.0 + f64::from(j));
                (x.sin() / x).powi(2 * times)
            };
            let exact: f64 = (-2000..=2000).map(image).sum();
            let made = law.folded(f_hz, 50.0);
            // The sum leaves out `(pi n j)^-4`, or less, of each image from the ninth on.
            let left_out = 2.0 / (3.0 * 8.5_f64.powi(3) * (PI * n).powi(4));
            assert!(
                (0.0..left_out).contains(&(exact - made)) || (exact - made).abs() < 1e-12,
                "{law:?} {f_hz} Hz: {made} {exact}"
            );
        }
    }
    // Once over whole samples it is a running mean.
    let [within, behind] = [&[0.1, 1.0][..], &[0.1]].map(Averaging::of);
    for f_hz in [0.3, 7.0, 21.0] {
        let ratio = within.folded(f_hz, 50.0) / behind.running(f_hz, 50.0);
        // What the sum leaves out of a single sinc's square: 2 / (8.5 pi^2) of it at most.
        assert!((ratio - 1.0).abs() < 0.025, "{f_hz} Hz: {ratio}");
    }
}

#[test]
fn a_mean_is_over_the_samples_before_it() {
    let mut samples: Vec<f64> = (0..100).map(f64::from).collect();
    let law = Averaging::of(&[0.25]);
    law.distorter(10.0, Seed { seed: 0, stream: 0 })
        .apply(&mut samples);
    // Two and a half samples of a ramp: (k + k - 1 + (k - 2) / 2) / 2.5.
    for (k, value) in samples.iter().enumerate().skip(3) {
        assert!((value - (k as f64 - 0.8)).abs() < 1e-9, "{k}: {value}");
    }
    assert_eq!(samples.len(), 100);
}

#[test]
fn allan_variance_follows_the_law() {
    for duration_s in [0.002, 0.0237] {
        let effects = format!(
            r#"{{ "effect": "averaging", "parameters": {{ "duration_s": {duration_s} }} }}"#
        );
        let axis = trial::axis(r#""N": 0.02, "K": 20, "Q": 4e-4"#, &effects);
        trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 8, 24, 100]);
    }
}

#[test]
fn means_of_means_follow_the_law_within_a_converter_and_behind_it() {
    for more in [r#""times": 3"#, r#""times": 2, "own_rate": 1"#] {
        let effects = format!(
            r#"{{ "effect": "averaging", "parameters": {{ "duration_s": 0.005, {more} }} }}"#
        );
        let axis = trial::axis(r#""N": 0.02, "K": 20"#, &effects);
        trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 8, 24, 100]);
    }
}

#[test]
fn the_record_has_as_many_samples_and_its_level_from_the_start() {
    let mut noise = Gaussian::new(Seed { seed: 3, stream: 0 }, 1.0);
    let mut samples: Vec<f64> = (0..500).map(|_| 1e3 + noise.draw()).collect();
    let law = Averaging::of(&[1.7]);
    law.distorter(10.0, Seed { seed: 0, stream: 0 })
        .apply(&mut samples);
    assert_eq!(samples.len(), 500);
    // Half of a mirrored mean counts twice: a variance of 2 / 17 at most, five deviations.
    assert!(
        samples.iter().all(|value| (value - 1e3).abs() < 1.8),
        "seed 3"
    );
}
