//! What departs from the rest and is no burst.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use super::*;
use crate::diagnosis::detect::look::Lesson;
use crate::diagnosis::detect::trial::{self, Trial, noise, outlier};
use crate::diagnosis::record::wave::Wave;
use crate::model::random::{Gaussian, Seed};
use crate::model::telegraph;

/// Noise with a stretch that is `factor` times as loud.
fn values(seed: u64, stretch: Range<usize>, factor: f64) -> Vec<f64> {
    let mut values = noise(seed);
    values[stretch].iter_mut().for_each(|one| *one *= factor);
    values
}

/// What is found of noise with a stretch.
fn asked(seed: u64, stretch: Range<usize>, factor: f64) -> Option<Candidate> {
    let trial = Trial::new(values(seed, stretch, factor));
    trial::candidate(trial.ask(&DETECTOR))
}

#[test]
fn a_loud_and_a_quiet_stretch_are_bursts() {
    for (seed, factor) in [(0, 2.0), (1, 0.4)] {
        let found = asked(seed, 9000..11_000, factor).expect("a plain burst");
        assert_eq!(found.supersedes, [outliers::KIND], "seed {seed}");
        let [from_s, to_s, found, _] = found.effect.plain()[..] else {
            panic!("seed {seed}: {:?}", found.effect);
        };
        // Ends within some blocks; the factor of 2000 samples within 1.6 %, the walk aside: 5 sigma.
        assert!(
            (from_s - 90.0).abs() < 2.0 && (to_s - 110.0).abs() < 2.0,
            "seed {seed}: {from_s} {to_s}"
        );
        assert!((found / factor).ln().abs() < 0.08, "seed {seed}: {found}");
    }
    assert!(asked(2, 0..0, 1.0).is_none(), "seed 2");
}

#[test]
fn what_lasts_for_most_of_the_record_is_its_law() {
    let length = noise(3).len();
    assert!(asked(3, length / 4..length / 2, 2.0).is_some(), "seed 3");
    assert!(
        asked(3, length * 23 / 100..length * 77 / 100, 2.0).is_none(),
        "seed 3"
    );
}

#[test]
fn on_a_grid_a_quiet_stretch_rests_and_a_loud_one_is_a_burst() {
    for (factor, is_found) in [(0.4, false), (2.0, true)] {
        let mut trial = Trial::new(values(4, 9000..11_000, factor));
        trial.know(rounding::KIND, [0.5], Change::Grid { decides: false });
        assert_eq!(
            !trial.ask(&DETECTOR).is_empty(),
            is_found,
            "seed 4, factor {factor}"
        );
    }
}

#[test]
fn where_the_grid_decides_or_the_strength_moves_nothing_is_a_burst() {
    let mut trial = Trial::new(values(5, 9000..11_000, 2.0));
    trial.character.strength_moves = true;
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 5, moving");
    trial.character.strength_moves = false;
    trial.know(rounding::KIND, [4.0], Change::Grid { decides: true });
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 5, on a grid");
}

#[test]
fn what_is_left_about_an_outlier_is_no_burst() {
    for (length, index, is_found) in [
        (128, 9000 + 150, false),
        (128, 12_000, true),
        // A long stretch is more than what one leaves.
        (2000, 9000 + 150, true),
    ] {
        let mut trial = Trial::new(values(6, 9000..9000 + length, 3.0));
        let waves = vec![Wave::Outliers(Arc::new(vec![outlier(index, 0.0)]))];
        trial.know(outliers::KIND, [0.01, 10.0], Change::Waves(waves));
        assert_eq!(
            !trial.ask(&DETECTOR).is_empty(),
            is_found,
            "seed 6, {length} samples, {index}"
        );
    }
}

#[test]
fn what_is_louder_where_an_excluded_band_is_belongs_to_it() {
    for (amplitude, is_found) in [(0.0, true), (4.0, false)] {
        let mut values = values(7, 9000..10_000, 1.6);
        for (n, value) in values.iter_mut().enumerate().take(10_000).skip(9000) {
            *value += amplitude * (TAU * 0.2 * n as f64).cos();
        }
        let mut trial = Trial::new(values);
        trial.exclude(19.0, 21.0);
        let found = trial.ask(&DETECTOR);
        assert_eq!(!found.is_empty(), is_found, "seed 7, tone of {amplitude}");
    }
}

#[test]
fn what_is_louder_in_some_band_only_is_no_burst() {
    let mut values = noise(8);
    for (n, value) in values.iter_mut().enumerate().take(11_000).skip(9000) {
        *value += 2.0 * (TAU * 0.2 * n as f64).cos();
    }
    let trial = Trial::new(values);
    assert!(
        burst(&trial.axis.powers(), trial::LEVEL).is_some(),
        "seed 8"
    );
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 8");
}

#[test]
fn where_the_level_switches_a_stretch_shorter_than_a_dwell_is_no_burst() {
    for (dwell_s, is_found) in [(5.0, true), (30.0, false)] {
        let mut trial = Trial::new(values(9, 9000..11_000, 2.0));
        trial.know(telegraph::KIND, [1.0, dwell_s], trial::steps(&[]));
        assert_eq!(
            !trial.ask(&DETECTOR).is_empty(),
            is_found,
            "seed 9, {dwell_s} s"
        );
    }
}

#[test]
fn a_fourth_stretch_says_that_the_strength_moves() {
    let mut trial = Trial::new(values(10, 14_000..16_000, 2.0));
    for start in [2000, 5000, 8000] {
        let ends_s = [
            start as f64 / trial::RATE_HZ,
            start as f64 / trial::RATE_HZ + 20.0,
        ];
        let change = Change::Mask(vec![start..start + 2000]);
        trial.know(KIND, [ends_s[0], ends_s[1], 2.0], change);
    }
    let proposals = trial.ask(&DETECTOR);
    assert!(
        trial::teaches(&proposals, &Lesson::StrengthMoves),
        "seed 10"
    );
    for kind in [KIND, outliers::KIND] {
        assert!(trial::withdraws(&proposals, kind), "seed 10: {kind}");
    }
}

#[test]
fn a_short_stretch_beside_a_burst_is_its_end_and_one_far_from_it_another() {
    for (start, is_joined) in [(11_100, true), (16_100, false)] {
        let mut trial = Trial::new(values(11, start..start + 600, 2.0));
        let known = Change::Mask(vec![8900..11_000]);
        trial.know(KIND, [90.0, 110.0, 3.0], known);
        let found = trial::candidate(trial.ask(&DETECTOR)).expect("a plain burst");
        assert_eq!(found.amends, is_joined.then_some(0), "seed 11, {start}");
        if is_joined {
            // From the outer ends of both, with the factor of the longer.
            let [from_s, to_s, factor] = found.effect.plain()[..] else {
                panic!("seed 11: {:?}", found.effect);
            };
            assert!(
                from_s == 90.0 && (to_s - 117.0).abs() < 2.0 && factor == 3.0,
                "seed 11: {:?}",
                found.effect
            );
            assert!(
                matches!(&found.change, Change::Mask(all) if all.len() == 2),
                "seed 11"
            );
        }
    }
}

#[test]
fn a_long_stretch_beside_a_long_burst_is_another() {
    let mut trial = Trial::new(values(12, 12_000..14_000, 2.0));
    let known = Change::Mask(vec![8900..11_000]);
    trial.know(KIND, [90.0, 110.0, 3.0], known);
    let found = trial::candidate(trial.ask(&DETECTOR)).expect("a plain burst");
    assert_eq!(found.amends, None, "seed 12");
}

#[test]
fn a_burst_that_is_refused_is_not_proposed() {
    let mut trial = Trial::new(values(0, 9000..11_000, 2.0));
    trial.refuse(KIND);
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 0");
}

/// Noise that is louder after it was loud: its variance feeds on its own squares.
fn lasting(seed: u64) -> Vec<f64> {
    let mut normal = Gaussian::new(Seed { seed, stream: 4 }, 1.0);
    let mut variance = 1.0_f64;
    let next = |_| {
        let value = variance.sqrt() * normal.draw();
        variance = 0.03 + 0.15 * value * value + 0.82 * variance;
        value
    };
    (0..70_001).map(next).collect()
}

#[test]
fn a_loud_stretch_of_noise_whose_strength_lasts_is_no_burst() {
    let mut passed_for_bursts = Vec::new();
    for seed in 40..48 {
        let trial = Trial::new(lasting(seed));
        if trial.look(even).is_some() {
            passed_for_bursts.push(seed);
        }
        assert!(trial.ask(&DETECTOR).is_empty(), "seed {seed}");
    }
    assert!(
        !passed_for_bursts.is_empty(),
        "nothing to refuse, seeds 40..48"
    );
}

#[test]
fn on_a_coarse_grid_a_stretch_that_its_level_makes_louder_is_none() {
    use crate::diagnosis::explanation::Change;
    use crate::model::rounding;
    // Normal noise of 0.45 steps about a value of the grid, and between two of them in the stretch.
    const STEP: f64 = 1.0;
    let seed = 12;
    let rounded = |louder: f64| {
        let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 0.45 * STEP);
        let values = (0..40_000).map(|n| {
            let within = (15_000..25_000).contains(&n);
            let (level, factor) = if within {
                (0.5 * STEP, louder)
            } else {
                (0.0, 1.0)
            };
            ((level + factor * normal.draw()) / STEP).round() * STEP - level
        });
        Trial::new(values.collect())
    };
    for (louder, is_burst) in [(1.0, false), (1.5, true)] {
        let mut trial = rounded(louder);
        let found = trial::candidate(trial.ask(&DETECTOR));
        assert!(found.is_some(), "seed {seed}: no stretch at all");
        trial.know(rounding::KIND, [STEP], Change::Grid { decides: false });
        let found = trial::candidate(trial.ask(&DETECTOR));
        assert_eq!(found.is_some(), is_burst, "seed {seed}, {louder}");
    }
}
