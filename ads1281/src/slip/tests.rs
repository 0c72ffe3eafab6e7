//! Levels that jump by two, and noise that must not look like it.

use super::*;

/// Uniform noise of +-`amplitude` by a 64-bit linear congruential generator (Knuth).
struct Noise(u64);

impl Noise {
    fn next(&mut self, amplitude: i32) -> i32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let span = 2 * i64::from(amplitude) + 1;
        ((self.0 >> 33) as i64 % span - i64::from(amplitude)) as i32
    }
}

/// Words until the first slip is confirmed, for a level that changes from `before` to
/// `after` at word 1000, with noise that scales with the level.
fn first_slip(before: i32, after: i32, noise: i32, seed: u64) -> Option<(usize, Slip)> {
    let mut detector = SlipDetector::new();
    let mut random = Noise(seed);
    (0..3000).find_map(|k| {
        let (level, scale) = if k < 1000 {
            (before, f64::from(noise))
        } else {
            let scale = f64::from(after) / f64::from(before);
            (after, f64::from(noise) * scale.abs())
        };
        match detector.push(level + random.next(scale as i32)) {
            Verdict::Slipped(slip) => Some((k, slip)),
            _ => None,
        }
    })
}

/// 1 g and a zero-g error of 60 mg on the 4 g range, in 31-bit steps, noise of 6 mg.
const LEVELS: [i32; 4] = [132_000_000, -132_000_000, 30_000_000, -60_000_000];
const NOISE: i32 = 800_000;

#[test]
fn a_slip_is_seen_on_an_axis_with_offset() {
    for (seed, level) in LEVELS.into_iter().enumerate() {
        let seed = seed as u64;
        let confirmed = 1000 + CONFIRM as usize - 1;
        assert_eq!(
            first_slip(level, 2 * level, NOISE, seed),
            Some((confirmed, Slip::Doubled)),
            "level {level} seed {seed}"
        );
        assert_eq!(
            first_slip(level, level / 2, NOISE, seed),
            Some((confirmed, Slip::Halved)),
            "level {level} seed {seed}"
        );
    }
}

#[test]
fn a_doubled_level_that_overflows_is_seen() {
    let level = 700_000_000;
    let mut detector = SlipDetector::new();
    let mut random = Noise(1);
    for _ in 0..1000 {
        detector.push(level + random.next(NOISE));
    }
    let shifted = |value: i32| (value << 2) >> 1;
    let verdicts = [(); CONFIRM as usize].map(|()| {
        let word = shifted(level + random.next(NOISE));
        detector.push(word)
    });
    assert_eq!(verdicts.last(), Some(&Verdict::Slipped(Slip::Doubled)));
}

#[test]
fn steps_of_other_ratios_are_signals() {
    for (seed, level) in LEVELS.into_iter().enumerate() {
        for percent in [
            -200, -100, -50, 0, 20, 40, 60, 75, 120, 150, 180, 220, 300, 400,
        ] {
            let after = (i64::from(level) * percent / 100) as i32;
            let seed = seed as u64;
            assert_eq!(
                first_slip(level, after, NOISE, seed),
                None,
                "level {level} to {percent} % seed {seed}"
            );
        }
    }
}

#[test]
fn noise_around_zero_never_slips() {
    for seed in 0..20 {
        let mut detector = SlipDetector::new();
        let mut random = Noise(seed);
        for k in 0..100_000 {
            let verdict = detector.push(random.next(NOISE));
            assert!(
                matches!(verdict, Verdict::Usual | Verdict::Strange),
                "word {k} seed {seed}: {verdict:?}"
            );
        }
    }
}

#[test]
fn a_signal_that_doubles_through_a_filter_is_a_signal() {
    // A step that takes four words and overshoots by 9 %, as a step behind the converter's
    // filter does.
    let level = 100_000_000;
    let mut detector = SlipDetector::new();
    for _ in 0..1000 {
        detector.push(level);
    }
    let percent = (0..200).map(|k| match k {
        0 => 95,
        1 => 120,
        2 => 180,
        3 => 209,
        4 => 195,
        5 => 206,
        _ => 200,
    });
    for (k, percent) in percent.enumerate() {
        let verdict = detector.push(level / 100 * percent);
        assert!(!matches!(verdict, Verdict::Slipped(_)), "word {k}");
    }
}
