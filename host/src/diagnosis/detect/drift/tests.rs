use super::*;
use crate::diagnosis::detect::level;
use crate::diagnosis::detect::trial::{self, LEVEL, RATE_HZ, Trial};
use crate::model::burst;
use crate::model::random::{Gaussian, Seed};

/// Samples of a record of a seed, odd.
fn length(seed: u64) -> usize {
    20_001 + 2 * (997 * seed as usize % 8_000)
}

/// White noise of deviation 1 and a walk whose steps have this one.
fn noise(seed: u64, walk: f64) -> Vec<f64> {
    let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let mut level = 0.0;
    (0..length(seed))
        .map(|_| {
            level += walk * normal.draw();
            level + normal.draw()
        })
        .collect()
}

/// A course of four waves of random size, the longest two records long.
fn course(seed: u64, size: f64) -> impl Fn(usize) -> f64 {
    let mut normal = Gaussian::new(Seed { seed, stream: 1 }, size);
    let sizes: Vec<f64> = (0..8).map(|_| normal.draw()).collect();
    let length = length(seed) as f64;
    move |n| {
        let waves = sizes.chunks_exact(2).enumerate();
        let at = |wave: usize| PI * (wave + 1) as f64 * n as f64 / length;
        waves
            .map(|(wave, sizes)| {
                (sizes[0] * at(wave).cos() + sizes[1] * at(wave).sin()) / (wave + 1) as f64
            })
            .sum()
    }
}

fn found(values: Vec<f64>, level: f64) -> Option<Found> {
    let mut trial = Trial::new(values);
    trial.level = level;
    trial.look(find)
}

#[test]
fn walk_and_ramps_are_smooth_by_chance_alone() {
    // At 2 % of 40 records six or more have a probability of 1e-4.
    for (walk, per_sample) in [
        (0.0, 0.0),
        (1e-3, 0.0),
        (1e-2, 0.0),
        (0.1, 0.0),
        (1e-3, 1e-3),
    ] {
        let alarms = (0..40).filter(|&seed| {
            let mut values = noise(seed, walk);
            let ramp = values.iter_mut().enumerate();
            ramp.for_each(|(n, value)| *value += per_sample * n as f64);
            found(values, 0.02).is_some()
        });
        let alarms: Vec<u64> = alarms.collect();
        assert!(alarms.len() < 6, "walk {walk}: seeds {alarms:?}");
    }
}

#[test]
fn a_smooth_course_is_found_and_its_levels_held() {
    let (mut held, mut all) = (0, 0);
    for seed in 100..140 {
        let truth = course(seed, 3.0);
        let mut values = noise(seed, 0.0);
        let count = values.len();
        let each = values.iter_mut().enumerate();
        each.for_each(|(n, value)| *value += truth(n));
        let found = found(values, LEVEL).unwrap_or_else(|| panic!("seed {seed}: nothing"));
        let Course {
            drift, levels_sd, ..
        } = found.course;
        // The record's own mean is no part of a course.
        let mean = (0..count).map(&truth).sum::<f64>() / count as f64;
        let last = drift.levels.len() - 1;
        for (place, (level, sd)) in drift.levels.iter().zip(levels_sd).enumerate() {
            let at = place * count / last;
            held += usize::from((level - truth(at) + mean).abs() < 1.96 * sd);
            all += 1;
        }
    }
    // Neighbouring levels share their error: a record's are worth about five.
    let share = f64::from(held as u32) / f64::from(all as u32);
    let sd = (0.95 * 0.05 / 200.0_f64).sqrt();
    assert!((share - 0.95).abs() < 4.0 * sd, "{held} of {all}");
}

/// Noise with a course in it.
fn drifting(seed: u64) -> Vec<f64> {
    let truth = course(seed, 2.0);
    let mut values = noise(seed, 1e-3);
    let each = values.iter_mut().enumerate();
    each.for_each(|(n, value)| *value += truth(n));
    values
}

#[test]
fn jumps_and_settlings_that_stood_for_a_course_go() {
    let seed = 7;
    let mut values = drifting(seed);
    let middle = values.len() / 2;
    let step = |values: &[f64], height| {
        let mut trial = Trial::new(values.to_vec());
        let change = trial::steps(&[trial::jump(middle, height)]);
        trial.know(steps::KIND, [middle as f64 / RATE_HZ, height], change);
        trial.look(find).expect("a course").supersedes
    };
    assert_eq!(
        step(&values, 0.5),
        [steps::KIND],
        "seed {seed}: it was none"
    );
    trial::add(&mut values, &Wave::Steps(vec![trial::jump(middle, 3.0)]));
    assert_eq!(step(&values, 3.0), [], "seed {seed}: it was there");
}

#[test]
fn a_burst_beside_what_stood_for_a_course_goes_with_it() {
    let seed = 7;
    let values = drifting(seed);
    let middle = values.len() / 2;
    let gone = |with_step: bool| {
        let mut trial = Trial::new(values.clone());
        trial.know(burst::KIND, [0.0, 1.0, 1.1], Change::Mask(vec![0..100]));
        if with_step {
            let change = trial::steps(&[trial::jump(middle, 0.5)]);
            trial.know(steps::KIND, [middle as f64 / RATE_HZ, 0.5], change);
        }
        trial.look(|look| match proposal(look, find(look).expect("a course")) {
            Proposal::Explain(one) => one.supersedes,
            _ => panic!("seed {seed}: no explanation"),
        })
    };
    assert_eq!(gone(true), [steps::KIND, burst::KIND], "seed {seed}");
    assert_eq!(gone(false), [], "seed {seed}: nothing stood for it");
}

#[test]
fn a_jump_a_settling_or_a_wave_is_no_course() {
    use crate::model::kind::Kind;
    let named = |seed: u64, wave: &Wave| -> Kind {
        let mut values = noise(seed, 1e-3);
        trial::add(&mut values, wave);
        let found = trial::candidate(Trial::new(values).ask(&level::IN_NOISE_ANEW));
        found.expect("something").effect.kind
    };
    for seed in 0..4 {
        let middle = length(seed) / 3;
        let jump = Wave::Steps(vec![trial::jump(middle, 1.0)]);
        assert_eq!(named(seed, &jump), steps::KIND, "seed {seed}");
        let settling = trial::settling(2.0, 15.0);
        assert_eq!(named(seed, &settling), warmup::KIND, "seed {seed}");
    }
}

#[test]
fn a_course_is_looked_for_once_and_not_where_it_was_refused() {
    let seed = 9;
    let truth = course(seed, 3.0);
    let mut values = noise(seed, 1e-3);
    let each = values.iter_mut().enumerate();
    each.for_each(|(n, value)| *value += truth(n));
    let mut trial = Trial::new(values);
    assert!(trial.look(find).is_some(), "seed {seed}");
    trial.refuse(KIND);
    assert!(trial.look(find).is_none(), "seed {seed}: refused");
    trial.refused.clear();
    // Known, but nothing of it was taken out.
    trial.know(KIND, [1.0, 0.0], Change::Grid { decides: false });
    assert!(trial.look(find).is_none(), "seed {seed}: known");
}

/// Noise with a course.
fn with_course(seed: u64) -> Vec<f64> {
    let truth = course(seed, 3.0);
    let mut values = noise(seed, 1e-3);
    let each = values.iter_mut().enumerate();
    each.for_each(|(n, value)| *value += truth(n));
    values
}

#[test]
fn what_costs_more_than_it_explains_goes_for_a_course() {
    let seed = 11;
    let mut values = with_course(seed);
    let middle = values.len() / 2;
    let jump = trial::jump(middle, 3.0);
    trial::add(&mut values, &Wave::Steps(vec![jump]));
    // Ten thousand numbers cost 45 000 nats, a jump of three deviations explains far less.
    for (freedom, goes) in [(2.0, false), (1e4, true)] {
        let mut trial = Trial::new(values.clone());
        let effect = Estimate::new(steps::KIND, [1.0, 3.0].map(Value::exact));
        trial.accept(Candidate::new(effect, 1e-9, freedom, trial::steps(&[jump])));
        let found = trial.look(find).expect("a course");
        assert_eq!(!found.supersedes.is_empty(), goes, "seed {seed}: {freedom}");
    }
}

#[test]
fn a_course_takes_the_noise_below_its_own_frequencies_with_it() {
    let seed = 12;
    let values = with_course(seed);
    let half_wave_hz = 0.5 * RATE_HZ / values.len() as f64;
    let absorbs_hz = found(values, LEVEL).expect("a course").course.absorbs_hz;
    // Four half-waves a record are in it; at the hundredth it has a millionth of what it has at the third.
    let waves = absorbs_hz / half_wave_hz;
    assert!((4.0..100.0).contains(&waves), "seed {seed}: {waves}");
}

#[test]
fn what_lies_in_an_excluded_band_is_no_course() {
    let seed = 13;
    let mut trial = Trial::new(with_course(seed));
    let half_wave_hz = 0.5 * RATE_HZ / length(seed) as f64;
    assert!(trial.look(find).is_some(), "seed {seed}");
    trial.exclude(0.0, 300.0 * half_wave_hz);
    assert!(trial.look(find).is_none(), "seed {seed}: excluded");
}

#[test]
fn a_band_that_was_unsteady_for_a_course_counts_again() {
    use crate::diagnosis::trial::excluded;
    const SEED: u64 = 70;
    let course = course(SEED, 300.0);
    let mut values = noise(SEED, 0.0);
    let all = values.iter_mut().enumerate();
    all.for_each(|(n, value)| *value += course(n));
    let mut trial = Trial::new(values);
    trial.axis.exclude(excluded(0.01 * RATE_HZ, 0.02 * RATE_HZ));
    let found = trial::candidate(trial.ask(&level::IN_NOISE_ANEW)).expect("a course");
    assert_eq!(found.effect.kind, KIND, "seed {SEED}");
    trial.accept(found);
    assert!(trial.axis.excluded().is_empty(), "seed {SEED}");
}
