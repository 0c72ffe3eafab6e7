//! The law of a roll-off, and that what is made follows it.

use super::*;
use crate::model::random::Gaussian;
use crate::model::trial;

/// What comes of white noise at 1000/s behind a corner, in blocks of this many samples.
fn filtered(corner_hz: f64, seed: u64, count: usize, block: usize) -> Vec<f64> {
    let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let mut filter = RollOff {
        corner_hz,
        poles: 1,
        times: 1,
        place: Place::Ahead,
    }
    .distorter(1000.0, Seed { seed, stream: 1 });
    let mut made = Vec::new();
    while made.len() < count {
        let mut samples: Vec<f64> = (0..block).map(|_| noise.draw()).collect();
        filter.apply(&mut samples);
        made.append(&mut samples);
    }
    made.truncate(count);
    made
}

#[test]
fn the_filter_has_the_response_of_the_law() {
    const RATE_HZ: f64 = 10.0;
    let one = [1e-6, 3.6e-3, 7.5e-3, 0.1, 0.5, 8.0].map(|share| (1, 1, share, Place::Ahead));
    let more = [
        (1, 1, 0.1, Place::Within),
        (2, 1, 0.01, Place::Within),
        (2, 1, 0.4, Place::Within),
        (4, 1, 0.2, Place::Within),
        (1, 2, 0.1, Place::Within),
        (1, 1, 0.05, Place::Behind),
        (2, 1, 0.02, Place::Behind),
        (4, 1, 0.2, Place::Behind),
        (2, 2, 0.1, Place::Behind),
    ];
    for (poles, times, share, place) in one.into_iter().chain(more) {
        let law = RollOff {
            corner_hz: share * RATE_HZ,
            poles,
            times,
            place,
        };
        let filter = Filter::new(
            law.digital(RATE_HZ),
            |f_hz| law.power(f_hz, RATE_HZ),
            RATE_HZ,
        );
        for f_hz in (1..90).map(|step| 0.05 * f64::from(step)) {
            let made = filter.power(TAU * f_hz / RATE_HZ);
            let meant = law.power(f_hz, RATE_HZ);
            // Less than 0.02 dB, or 60 dB below all else, which no record shows.
            let off = (made - meant).abs() / meant.max(1e-6 / 4e-3);
            assert!(off < 4e-3, "{law:?} {f_hz} Hz: {made} {meant}");
        }
    }
}

#[test]
fn several_poles_and_the_rounding_behind_them_follow_the_law() {
    // A record of a few codes: rounding is most of what is left near half the rate.
    let rounding = r#"{ "effect": "quantisation", "parameters": { "step": 0.1 } }"#;
    for more in [
        r#""poles": 1"#,
        r#""poles": 2"#,
        r#""poles": 4, "own_rate": 1"#,
    ] {
        let filter =
            format!(r#"{{ "effect": "rolloff", "parameters": {{ "corner_hz": 60, {more} }} }}"#);
        let effects = format!("{filter}, {rounding}");
        let axis = trial::axis(r#""N": 0.02, "K": 1"#, &effects);
        trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 8, 24, 100]);
    }
}

#[test]
fn a_corner_far_below_the_rate_has_its_power() {
    const SEED: u64 = 71;
    const COUNT: usize = 1 << 18;
    let corner_hz = 1.0;
    let made = filtered(corner_hz, SEED, COUNT, 4096);
    let power = made.iter().map(|x| x * x).sum::<f64>() / made.len() as f64;
    // White noise of 2 / rate a hertz up to pi / 2 corners.
    let expected = PI * corner_hz / 1000.0;
    // As many independent values as the corner leaves: a relative deviation of sqrt(2 / (2 pi corner count / rate)),
    // 3.5 %; four times that.
    let ratio = power / expected;
    assert!((ratio - 1.0).abs() < 0.14, "seed {SEED}: {ratio}");
}

#[test]
fn the_record_is_as_loud_at_its_beginning_as_later() {
    const RECORDS: u64 = 200;
    let mut squares = [0.0; 2];
    for seed in 0..RECORDS {
        let made = filtered(200.0, seed, 4096, 1024);
        // The mirror's edge is a few samples long.
        squares[0] += made[8..264].iter().map(|x| x * x).sum::<f64>();
        squares[1] += made[2048..2304].iter().map(|x| x * x).sum::<f64>();
    }
    // 51200 samples each, tied over a few: 1.2 % of the ratio, four times that.
    let ratio = squares[0] / squares[1];
    assert!((ratio - 1.0).abs() < 0.05, "seeds 0..{RECORDS}: {ratio}");
}

#[test]
fn blocks_make_no_difference() {
    let whole = filtered(200.0, 3, 3000, 4096);
    for block in [1, 129, 700, 1000] {
        assert_eq!(filtered(200.0, 3, 3000, block), whole, "blocks of {block}");
    }
}
