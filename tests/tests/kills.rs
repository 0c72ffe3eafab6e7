//! The short form of `cargo xtask faults --kills 200`.
#![cfg(target_os = "linux")]

use inm_tests::hidden::judge::program::Program;
use inm_tests::night::kill;

/// Recordings that are killed: a dozen seconds.
const KILLS: u64 = 10;

#[test]
fn a_recording_that_is_killed_has_all_that_was_written() {
    let inm = Program::built().0;
    let mut conversions = 0;
    for seed in 0..KILLS {
        let killed = kill(&inm, seed).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        assert!(killed.is_sound(), "seed {seed}: {killed:?}");
        conversions += killed.conversions;
    }
    // Most of them had something to lose.
    assert!(conversions > 1000 * KILLS, "{conversions} conversions");
}
