//! Lines: their frequencies and amplitudes.

use super::{Alone, amplitude, near};

#[test]
fn a_sinusoid_is_a_cosine_of_its_amplitude() {
    for seed in 1..4 {
        let alone = Alone::new("sinusoid", 1.0, seed);
        let expected = alone.parameter("amplitude");
        let found = amplitude(&alone.samples, alone.parameter("f_hz"));
        // A record does not hold a whole number of cycles: at worst 1 / (pi cycles).
        near(found, expected, expected / 100.0, seed);
    }
}

#[test]
fn a_hum_has_its_harmonics() {
    for seed in 1..4 {
        let alone = Alone::new("hum", 1e3, seed);
        let base_hz = alone.parameter("f_hz");
        let mut harmonics = 0;
        for number in 1..=5_u32 {
            let name = format!("amplitude_{number}");
            let expected = alone.truth().parameter(&name).unwrap_or(0.0);
            harmonics += u32::from(expected > 0.0);
            let found = amplitude(&alone.samples, f64::from(number) * base_hz);
            let largest = alone.parameter("amplitude_1");
            near(found, expected, largest / 500.0, seed);
        }
        assert!(harmonics >= 2, "seed {seed}");
    }
}

#[test]
fn a_wrong_timebase_moves_all_lines() {
    let alone = Alone::new("timebase", 1e3, 1);
    let ratio = alone.parameter("ratio");
    let there = alone.effect.in_reference().expect("a reference").truths();
    let here = alone.effect.truths();
    assert!(there.len() >= 2 && here.len() == there.len() + 1);
    for (here, there) in here.iter().zip(&there) {
        let (f_hz, true_hz) = (here.parameter("f_hz"), there.parameter("f_hz"));
        let (f_hz, true_hz) = (f_hz.expect("a line"), true_hz.expect("a line"));
        near(f_hz * ratio, true_hz, 1e-9 * true_hz, 1);
        let expected = here.parameter("amplitude").expect("a line");
        near(
            amplitude(&alone.samples, f_hz),
            expected,
            expected / 50.0,
            1,
        );
    }
}
