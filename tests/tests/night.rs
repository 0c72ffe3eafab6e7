//! The short form of a night at the bench: `cargo xtask night` for the long one.
#![cfg(target_os = "linux")]

use inm_tests::hidden::judge::program::Program;
use inm_tests::night::{Weather, night};

/// Some three minutes of samples in as many seconds, and everything happens several times.
const HOURS: f64 = 0.05;
const SEED: u64 = 3;
const WEATHER: Weather = Weather {
    speed: 60.0,
    cable_s: 60.0,
    power_s: 60.0,
    slips: true,
};

#[test]
fn every_sample_of_a_night_is_right_or_flagged_or_known_to_be_missing() {
    let night = night(&Program::built().0, HOURS, SEED, WEATHER);
    let night = night.unwrap_or_else(|error| panic!("seed {SEED}: {error}"));
    // Gaps there were, and nothing worse.
    assert_eq!(night.status, Some(1), "seed {SEED}: {night:?}");
    assert!(night.happened.restarts > 0, "seed {SEED}: {night:?}");
    for axis in &night.axes {
        assert_eq!(axis.wrong, 0, "seed {SEED}: {axis:?}");
        assert!(
            axis.flagged > 0 && axis.right > 400_000,
            "seed {SEED}: {axis:?}"
        );
        assert_eq!(axis.right + axis.flagged + axis.missing, axis.end);
    }
}
