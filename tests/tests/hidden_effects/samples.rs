//! Samples that repeat, are gone, or lie on a limit or a grid.

use inm_tests::hidden::draw::Draw;

use super::{Alone, RATE_HZ, near};

#[test]
fn stale_samples_repeat() {
    for seed in 1..4 {
        let alone = Alone::new("stale", 100.0, seed);
        let repeats = alone.samples.windows(2).filter(|w| w[0] == w[1]).count() as f64;
        let expected = alone.parameter("share") * alone.samples.len() as f64;
        near(repeats, expected, 5.0 * expected.sqrt(), seed);
    }
}

#[test]
fn dropped_samples_are_gone() {
    for seed in 1..4 {
        let alone = Alone::new("dropped", 1.0, seed);
        let missing = alone.parameter("samples_1") as usize;
        assert_eq!(alone.samples.len() + missing, 1 << 18, "seed {seed}");
        let at = (alone.parameter("time_s_1") * RATE_HZ) as usize;
        // The hum by itself, whole: what is behind the gap comes that much earlier.
        let hum = alone
            .effect
            .tones(&alone.scene, &mut Draw::new(0, ""), &|_| 1.0);
        let hum = hum.expect("a dropped sample shows in a hum");
        near(alone.samples[at - 1], hum[at - 1], 1e-6, seed);
        near(alone.samples[at], hum[at + missing], 1e-6, seed);
    }
}

#[test]
fn clipped_samples_lie_on_the_limit() {
    for seed in 1..4 {
        let alone = Alone::within("clipping", 5.0, 1e-3, seed);
        let side = alone.parameter("side");
        let (name, level) = &alone.settled[0];
        assert_eq!(name, "level");
        let on = alone.samples.iter().filter(|x| *x == level).count();
        assert_eq!(on, 50, "seed {seed}");
        assert!(
            alone.samples.iter().all(|x| x * side <= level * side),
            "seed {seed}"
        );
    }
}

#[test]
fn quantised_samples_are_multiples_of_the_step() {
    let alone = Alone::within("quantisation", 2.0, 1e-3, 1);
    let step = alone.parameter("step");
    // Twice the noise's deviation, sqrt(rate) N.
    near(step, 2.0 * 1e-3 * RATE_HZ.sqrt(), 1e-6, 1);
    for sample in &alone.samples {
        near((sample / step).round() * step, *sample, 1e-9, 1);
    }
}
