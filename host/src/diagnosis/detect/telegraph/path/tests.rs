//! Which records show two levels, and what is read off them.

use super::*;
use crate::diagnosis::detect::trial::{self, RATE_HZ, Trial, noise};
use crate::diagnosis::record::wave::Wave;
use crate::model::random::{Gaussian, Seed};

/// Deviations that the white noise of [`noise`] is below a height: differences of neighbours then have a spread of 1.4.
const HEIGHT: f64 = 40.0;

/// Noise on a level that goes to and fro by [`HEIGHT`] at these times apart, samples.
fn to_and_fro(seed: u64, dwells: impl Iterator<Item = usize>) -> Vec<f64> {
    let mut values = noise(seed);
    let (mut level, mut next) = (0.5 * HEIGHT, 0);
    let mut dwells = dwells;
    for (n, value) in values.iter_mut().enumerate() {
        if n == next {
            level = -level;
            next += dwells.next().unwrap_or(usize::MAX / 2);
        }
        *value += level;
    }
    values
}

/// Whole numbers of an exponential law of this mean, at least 1.
fn exponential(seed: u64, mean: f64) -> impl Iterator<Item = usize> {
    let mut normal = Gaussian::new(Seed { seed, stream: 7 }, 1.0);
    std::iter::repeat_with(move || {
        // Half the sum of two squares is exponential.
        let time = 0.5 * (normal.draw().powi(2) + normal.draw().powi(2));
        (mean * time) as usize + 1
    })
}

fn is_read_off(values: &[f64]) -> bool {
    read_off(values).is_some()
}

#[test]
fn levels_far_apart_are_read_off_jump_by_jump() {
    for seed in 0..4 {
        let (values, moments) = trial::switching(seed, HEIGHT);
        let path = read_off(&values).unwrap_or_else(|| panic!("seed {seed}: nothing"));
        let found: Vec<usize> = path.moments.iter().map(|one| one.0).collect();
        assert_eq!(found, moments, "seed {seed}");
        let off = (path.known.height - HEIGHT).abs() / path.known.height_sd;
        assert!(off < 5.0, "seed {seed}: {off} deviations");
        // Twenty-five samples on average, of some thousand times.
        let error = (path.dwell / 25.0).ln() * (moments.len() as f64).sqrt();
        assert!(error.abs() < 5.0, "seed {seed}: {}", path.dwell);
        assert!(path.known.edge.beside.is_empty(), "seed {seed}");
    }
}

#[test]
fn levels_that_noise_may_hide_are_left_to_their_law() {
    for seed in 10..14 {
        // Nine spreads of a difference of two means over four samples.
        let (values, _) = trial::switching(seed, 6.0);
        assert!(!is_read_off(&values), "seed {seed}");
    }
}

#[test]
fn what_is_taken_out_leaves_the_noise() {
    for seed in 20..23 {
        let values = to_and_fro(seed, exponential(seed, 60.0));
        let path = read_off(&values).unwrap_or_else(|| panic!("seed {seed}: nothing"));
        let mut left = values.clone();
        path.known.wave(&path.moments).take_out(&mut left);
        for (n, (left, noise)) in left.iter().zip(&noise(seed)).enumerate() {
            assert!(
                (left - noise).abs() < 0.5,
                "seed {seed}, sample {n}: {left}, {noise}"
            );
        }
    }
}

#[test]
fn a_filter_ahead_gives_every_jump_its_course() {
    for seed in 30..33 {
        // Dwells short of the filter's memory are another matter.
        let sharp = to_and_fro(seed, exponential(seed, 120.0).map(|time| time + 8));
        let own = noise(seed);
        // A level that follows by a half of what it lacks, beside the same noise.
        let mut level = sharp[0] - own[0];
        let pairs = sharp.iter().zip(&own);
        let values: Vec<f64> = pairs
            .map(|(sharp, own)| {
                level += 0.5 * (sharp - own - level);
                own + level
            })
            .collect();
        let path = read_off(&values).unwrap_or_else(|| panic!("seed {seed}: nothing"));
        let mut left = values;
        path.known.wave(&path.moments).take_out(&mut left);
        let beyond = left.iter().zip(&own).map(|(left, own)| (left - own).abs());
        let beyond = beyond.fold(0.0, f64::max);
        // A mean of dozens of jumps is known to a tenth of the noise; the largest of a hundred numbers is far below a half.
        assert!(beyond < 0.6, "seed {seed}: {beyond} of {HEIGHT} is left");
    }
}

#[test]
fn a_jump_while_nothing_was_measured_is_known_by_the_levels() {
    const SEED: u64 = 40;
    let mut values = to_and_fro(SEED, exponential(SEED, 150.0));
    let whole = read_off(&values).expect("two levels");
    // The jump in the middle lies alone in a gap of 20 samples.
    let alone = whole.moments.windows(3).position(|three| {
        three[1].0 > three[0].0 + 60 && three[2].0 > three[1].0 + 60 && three[0].0 > 4000
    });
    let at = whole.moments[alone.expect("a jump that stands alone") + 1].0;
    values[at - 10..at + 10].fill(f64::NAN);
    for more in [0..0, at - 50..at - 20] {
        // Another, longer gap ahead of it, in which nothing happened.
        values[more].fill(f64::NAN);
        let path = read_off(&values).expect("two levels");
        assert_eq!(path.moments.len(), whole.moments.len(), "seed {SEED}");
        let is_there = |one: &Moment| (at - 10..at + 10).contains(&one.0);
        assert_eq!(path.moments.iter().filter(|one| is_there(one)).count(), 1);
    }
}

#[test]
fn jumps_at_even_times_are_a_clock_and_no_switching() {
    assert!(!is_read_off(&to_and_fro(50, std::iter::repeat(60))));
    assert!(is_read_off(&to_and_fro(50, exponential(50, 60.0))));
}

#[test]
fn what_switches_for_a_while_only_is_no_switching() {
    for seed in 60..64 {
        // A tenth of the record: hundreds of jumps.
        let values = to_and_fro(seed, exponential(seed, 25.0));
        let begins = values.len() * 9 / 10;
        let mut some = to_and_fro(seed, std::iter::empty());
        some[begins..].copy_from_slice(&values[begins..]);
        assert!(is_read_off(&values), "seed {seed}");
        assert!(!is_read_off(&some), "seed {seed}");
    }
}

#[test]
fn samples_out_of_place_by_the_same_are_no_second_level() {
    let mut rest = exponential(51, 120.0);
    let mut is_out = false;
    let dwells = std::iter::repeat_with(move || {
        is_out = !is_out;
        if is_out { rest.next().unwrap_or(1) } else { 1 }
    });
    assert!(!is_read_off(&to_and_fro(51, dwells)));
}

#[test]
fn more_than_two_levels_are_not_two() {
    let mut values = noise(52);
    let mut normal = Gaussian::new(
        Seed {
            seed: 52,
            stream: 8,
        },
        1.0,
    );
    let (mut level, mut times, mut next) = (0.0, exponential(52, 60.0), 60);
    for (n, value) in values.iter_mut().enumerate() {
        if n == next {
            level += HEIGHT * normal.draw().signum();
            next += times.next().unwrap_or(60);
        }
        *value += level;
    }
    assert!(!is_read_off(&values), "seed 52");
}

#[test]
fn a_level_between_two_codes_does_not_switch() {
    // The noise is within a step of each: less than one code, and one in eight of the height.
    for (step, is_switching) in [(HEIGHT, false), (HEIGHT / 8.0, true)] {
        let mut values = to_and_fro(53, exponential(53, 60.0));
        let round = |value: &mut f64| *value = ((*value + 0.5 * HEIGHT) / step).round() * step;
        values.iter_mut().for_each(round);
        assert_eq!(is_read_off(&values), is_switching, "seed 53, step {step}");
    }
}

#[test]
fn levels_that_do_not_last_are_none() {
    // Behind a capacitor each jump is forgotten within a dwell.
    let sharp = to_and_fro(54, exponential(54, 100.0));
    let own = noise(54);
    let mut level = 0.0;
    let values = sharp.iter().zip(&own).map(|(sharp, own)| {
        level += (sharp - own - level) / 50.0;
        sharp - level
    });
    assert!(!is_read_off(&values.collect::<Vec<f64>>()), "seed 54");
}

#[test]
fn a_switching_that_was_read_off_is_named_once_and_leaves_no_law() {
    let mut trial = Trial::new(trial::switching(55, HEIGHT).0);
    let found = trial::candidate(trial.ask(&DETECTOR)).expect("two levels");
    assert_eq!(found.effect.kind, KIND, "seed 55");
    let [height, dwell_s] = found.effect.plain()[..] else {
        panic!("two parameters");
    };
    assert!((height / HEIGHT - 1.0).abs() < 0.01 && (dwell_s * RATE_HZ / 25.0).ln().abs() < 0.2);
    trial.accept(found);
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 55: again");
    let waves = trial.axis.residual.waves();
    assert!(matches!(waves, [Wave::Switching(_)]), "seed 55");
    let density = trial.axis.density(1.0) * RATE_HZ;
    // White noise of deviation 1 beside little else; a spectrum of 20 000 samples is known to some percent at 1 Hz.
    assert!((0.8..1.25).contains(&density), "seed 55: {density}");
}
