//! Tests of repeats beyond chance.

use super::*;
use crate::diagnosis::values::chance::NEVER;
use crate::model::axis::ModelEffect;
use crate::model::effect::Part;
use crate::model::random::Gaussian;
use crate::model::random::Seed;

const LENGTH: usize = 1 << 18;

/// White noise of a deviation of `sd` steps of size `step`; every `every`-th sample repeats.
fn increments(seed: u64, sd: f64, step: f64, every: usize) -> Vec<f64> {
    let mut noise = Gaussian::new(Seed { seed, stream: 0 }, sd);
    let mut values: Vec<f64> = Vec::with_capacity(LENGTH);
    for n in 0..LENGTH {
        let drawn = step * noise.draw().round();
        values.push(if n % every == every - 1 {
            values[n - 1]
        } else {
            drawn
        });
    }
    values.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

fn found(increments: &[f64], chance: Chance, level: f64) -> Option<Stale> {
    let repeats = (1..).zip(increments).filter(|(_, step)| **step == 0.0);
    let places: Vec<usize> = repeats.map(|(place, _)| place).collect();
    let measured = vec![0.0; increments.len() + 1];
    stale(Repeats::new(&measured, &places), chance, level)
}

fn spread(increments: &[f64]) -> f64 {
    let squares: f64 = increments.iter().map(|step| step * step).sum();
    (0.5 * squares / increments.len() as f64).sqrt()
}

#[test]
fn fine_codes_repeat_by_chance() {
    // Deviations from 3000 to 300 000 steps: 25 to 0.25 repeats by chance, 1 / (2 sd sqrt pi) a pair.
    for sd in [3e3, 2e4, 3e5] {
        let expected = LENGTH as f64 / (2.0 * sd * std::f64::consts::PI.sqrt());
        for declared in [Some(0.5), None] {
            let mut alarms = Vec::new();
            for seed in 0..40 {
                let steps = increments(seed, sd, 0.5, usize::MAX);
                let chance = Chance::between(&steps, spread(&steps), declared);
                // Read off some 64 to 128 increments: 5 standard deviations of 12.5 %; and
                // without a declared step a smallest increment of more than eight is none.
                let ratio = chance.count / expected;
                let is_none = declared.is_none() && chance.count == NEVER;
                assert!(
                    (0.4..1.65).contains(&ratio) || is_none,
                    "sd {sd}, seed {seed}: {chance:?}, {expected} expected"
                );
                if found(&steps, chance, 0.005).is_some() {
                    alarms.push(seed);
                }
            }
            // 0.2 expected; 3 or more have a probability of 1e-3.
            assert!(alarms.len() < 3, "sd {sd}: seeds {alarms:?}");
        }
    }
}

#[test]
fn a_number_of_known_mean_is_poisson_and_a_guessed_one_wider() {
    let of = |variance| Chance {
        count: 2.0,
        variance,
    };
    // 1 - e^-2 (1 + 2 + 2 + 4/3 + 2/3 + 4/15 + 4/45 + 8/315)
    let known = of(0.0).exceeded(8.0);
    assert!((known - 1.0967e-3).abs() < 1e-6, "{known}");
    let nearly = of(1e-4).exceeded(8.0);
    assert!((nearly / known - 1.0).abs() < 0.01, "{nearly}");
    assert!(of(1.0).exceeded(8.0) > 2.0 * known);
}

#[test]
fn repeats_beyond_chance_are_told_with_their_share() {
    for declared in [Some(0.5), None] {
        let steps = increments(1, 2e4, 0.5, 4096);
        let chance = Chance::between(&steps, spread(&steps), declared);
        let found = found(&steps, chance, 2e-4).expect("64 repeats where 3.7 are chance");
        let share = 1.0 / 4096.0;
        let error = (found.share - share).abs() / found.share_sd;
        assert!(error < 4.0, "{found:?}");
    }
}

#[test]
fn two_repeats_are_none_however_rare() {
    let chance = Chance {
        count: NEVER,
        variance: 0.0,
    };
    let apart = |count| Repeats {
        pairs: LENGTH,
        count,
        followed: count,
        by_another: 0,
    };
    assert!(stale(apart(2), chance, 1e-4).is_none());
    assert!(stale(apart(3), chance, 1e-4).is_some());
}

/// Samples that repeat the one before, as the effect draws them; what lies beyond so many deviations is missing.
fn repeats(share: f64, run_samples: f64, beyond: f64, seed: u64) -> Option<Stale> {
    let effect = ModelEffect::new(
        "stale",
        &[("share", share), ("run_samples", run_samples)]
            .map(|(name, value)| (name.to_owned(), value))
            .into(),
    );
    let Part::Distortion(effect) = effect.expect("sound").part() else {
        panic!("a distortion")
    };
    let mut samples: Vec<f64> = (0..1 << 16).map(f64::from).collect();
    effect
        .distorter(1.0, Seed { seed, stream: 0 })
        .apply(&mut samples);
    let mut normal = Gaussian::new(Seed { seed, stream: 1 }, 1.0);
    for sample in &mut samples {
        *sample = if normal.draw() > beyond {
            f64::NAN
        } else {
            *sample
        };
    }
    let places: Vec<usize> = (1..samples.len())
        .filter(|&n| samples[n] == samples[n - 1])
        .collect();
    let never = Chance {
        count: NEVER,
        variance: 0.0,
    };
    stale(Repeats::new(&samples, &places), never, 1e-4)
}

#[test]
fn runs_are_told_from_repeats_without_a_memory() {
    // None, a tenth and three tenths of a normal law lie beyond these.
    let (none, tenth, third) = (f64::INFINITY, 1.282, 0.524);
    for (share, run_samples, beyond) in [
        (0.002, 4.0, none),
        (0.05, 1.5, tenth),
        (0.3, 1.0, none),
        (0.6, 12.0, third),
    ] {
        let (mut off, mut share_off) = (Vec::new(), Vec::new());
        for seed in 0..100 {
            let found = repeats(share, run_samples, beyond, seed).expect("130 repeats or more");
            let (run, sd) = found.run_samples.expect("far from those without a memory");
            off.push((run - run_samples) / sd);
            share_off.push((found.share - share) / found.share_sd);
        }
        for off in [off, share_off] {
            // Deviations know themselves to a tenth for the shortest, and a share of 0.6 is overstated: none of 100 beyond 5.
            let worst = off.iter().fold(0.0, |most: f64, off| most.max(off.abs()));
            assert!(
                worst < 5.0,
                "{share}, {run_samples}, seeds 0 to 99: {worst}"
            );
        }
    }
    for share in [1e-3, 0.05, 0.5] {
        let told = |seed| {
            repeats(share, 0.0, tenth, seed)
                .expect("60 repeats")
                .run_samples
        };
        let wrong = (0..200).filter(|&seed| told(seed).is_some()).count();
        // 0.02 expected of 200 at 1e-4.
        assert!(wrong < 2, "{share}, seeds 0 to 199: {wrong}");
    }
}

#[test]
fn values_between_the_codes_that_are_declared_never_repeat() {
    let mut noise = Gaussian::new(Seed { seed: 4, stream: 0 }, 1.0);
    let steps: Vec<f64> = (0..LENGTH).map(|_| noise.draw()).collect();
    let chance = Chance::between(&steps, 1.0, Some(100.0));
    assert_eq!(chance.count, NEVER, "seed 4");
}

#[test]
fn values_of_no_grid_never_repeat() {
    let mut noise = Gaussian::new(Seed { seed: 3, stream: 0 }, 1.0);
    let steps: Vec<f64> = (0..LENGTH).map(|_| noise.draw()).collect();
    assert_eq!(Chance::between(&steps, 1.0, None).count, NEVER);
}
