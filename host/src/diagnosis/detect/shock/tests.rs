//! A shock is found for what it is, once, and nothing else is.

mod codes;
mod measured;
mod refused;
mod rules;

use std::f64::consts::PI;

use super::DETECTOR;
use super::trial::bump;
use crate::diagnosis::detect::trial::{self, RATE_HZ, Trial, noise};
use crate::diagnosis::explanation::Change;
use crate::diagnosis::record::wave::Wave;
use crate::model::shock::{KIND, Shock};

/// Adds shocks to a record.
fn add(values: &mut [f64], shocks: &[Shock]) {
    for shock in shocks {
        shock.add_to(0, values, RATE_HZ);
    }
}

fn ringing(time_s: f64, peak: f64) -> Shock {
    super::trial::ringing(time_s, peak, 7.3, 0.4)
}

/// Rows of the shocks that are told of a record.
fn told(values: Vec<f64>) -> Vec<Shock> {
    let found = trial::candidate(Trial::new(values).ask(&DETECTOR));
    let shocks = found.filter(|one| one.effect.kind == KIND);
    shocks.map_or_else(Vec::new, |one| {
        one.effect.plain().chunks(5).map(Shock::of).collect()
    })
}

#[test]
fn ringing_is_told_with_its_numbers_whatever_its_size() {
    for (seed, peak) in (0..).zip([6.0, -20.0, 100.0, -1e4]) {
        let mut values = noise(seed);
        add(&mut values, &[ringing(100.123, peak)]);
        let found = trial::candidate(Trial::new(values).ask(&DETECTOR));
        let found = found.unwrap_or_else(|| panic!("seed {seed}, {peak}: nothing"));
        let row = found.effect.plain();
        assert_eq!(row.len(), 5, "seed {seed}, {peak}: {row:?}");
        let shock = Shock::of(&row);
        // An amplitude over noise of deviation 1, whose peak is some 0.95 of it, rings for n = 40 samples a decay:
        // its logarithm, the decay's and the phase are known to about 1 / (peak sqrt(n / 4)), or 5 % at 6.
        let sd = 0.32 / peak.abs();
        let phase = 2.0 * PI * 7.3 * (shock.time_s - 100.123);
        for (name, off) in [
            ("time", phase / 2.0),
            ("peak", shock.peak / peak - 1.0),
            ("frequency", (shock.f_hz / 7.3 - 1.0) * 2.0 * PI * 7.3 * 0.4),
            ("decay", (shock.decay_s / 0.4 - 1.0) / 2.0),
        ] {
            assert!(
                off.abs() < 5.0 * sd + 1e-3,
                "seed {seed}, {peak}: {name} {off} of {sd}: {shock:?}"
            );
        }
        assert!(
            found.held_out_nats.is_some_and(|nats| nats > 0.0),
            "seed {seed}, {peak}"
        );
    }
}

#[test]
fn a_shock_is_seen_at_both_ends_and_beside_a_gap() {
    for (seed, place) in (10..).zip(["begin", "end", "gap"]) {
        let mut values = noise(seed);
        let length_s = values.len() as f64 / RATE_HZ;
        let time_s = match place {
            "begin" => 0.02,
            "end" => length_s - 0.3,
            _ => 80.01,
        };
        add(&mut values, &[ringing(time_s, 30.0)]);
        if place == "gap" {
            values[7000..8000].fill(f64::NAN);
        }
        let found = told(values);
        assert_eq!(found.len(), 1, "seed {seed}, {place}: {found:?}");
        assert!(
            (found[0].time_s - time_s).abs() < 0.1,
            "seed {seed}, {place}: {found:?}"
        );
    }
}

#[test]
fn bumps_do_not_ring() {
    for (seed, length_s) in (20..).zip([0.3, 1.0]) {
        let mut values = noise(seed);
        add(&mut values, &[bump(100.0, 40.0, length_s)]);
        let found = told(values);
        assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
        assert_eq!(found[0].f_hz, 0.0, "seed {seed}: {found:?}");
        let off = (found[0].duration_s / length_s - 1.0).abs();
        assert!(off < 0.05, "seed {seed}: {found:?}");
    }
}

#[test]
fn what_has_another_name_is_left_to_it() {
    for size in [12.0, 1e3, 1e5] {
        let mut outlier = noise(30);
        outlier[9000] += size;
        outlier[9500] -= size;
        assert!(told(outlier).is_empty(), "seed 30: outliers of {size}");
        let mut step = noise(31);
        trial::add(&mut step, &Wave::Steps(vec![trial::jump(9000, size)]));
        assert!(told(step).is_empty(), "seed 31: a step of {size}");
        let mut louder = noise(32);
        louder[9000..10_000]
            .iter_mut()
            .for_each(|value| *value *= size / 4.0);
        assert!(
            told(louder).is_empty(),
            "seed 32: a burst of {}",
            size / 4.0
        );
    }
    let (switching, _) = trial::switching(33, 4.0);
    assert!(told(switching).is_empty(), "seed 33: two levels");
}

#[test]
fn single_samples_come_together_by_chance_where_there_are_many() {
    const SEED: u64 = 34;
    // Twelve in 180 samples, none next to another.
    let clump = (0..12).map(|number| 9000 + 15 * number + number * number % 7);
    let kinds = |others: usize| {
        let mut values = noise(SEED);
        let all = spread(values.len(), others).chain(clump.clone());
        let far: Vec<usize> = all.collect();
        for (number, place) in far.into_iter().enumerate() {
            values[place] += if number % 2 == 0 { 30.0 } else { -30.0 };
        }
        trial::kinds(&Trial::new(values).ask(&DETECTOR))
    };
    assert!(kinds(400).is_empty(), "seed {SEED}: {:?}", kinds(400));
    assert!(!kinds(0).is_empty(), "seed {SEED}: by themselves");
}

#[test]
fn clean_records_hold_none() {
    // At a level of 2e-4 each, one of 60 has a probability of 1.2 %.
    let seen: Vec<u64> = (100..160)
        .filter(|&seed| !told(noise(seed)).is_empty())
        .collect();
    assert!(seen.is_empty(), "seeds {seen:?}");
}

/// Places of single samples, `count` of them, evenly over a record.
fn spread(len: usize, count: usize) -> impl Iterator<Item = usize> {
    (1..=count).map(move |n| n * len / (count + 1))
}

#[test]
fn a_short_shock_among_many_single_samples_is_some_that_came_together() {
    for seed in 40..43 {
        let with = |singles: usize, size: f64| {
            let mut values = noise(seed);
            let len = values.len();
            spread(len, singles).for_each(|place| values[place] += 20.0);
            add(&mut values, &[bump(91.037, size, 6.0 / RATE_HZ)]);
            told(values)
        };
        assert_eq!(with(0, 15.0).len(), 1, "seed {seed}: alone");
        assert_eq!(with(3, 15.0).len(), 1, "seed {seed}: beside three");
        assert!(
            with(10, 15.0).is_empty(),
            "seed {seed}: beside ten: {:?}",
            with(10, 15.0)
        );
        // One that stands out far beyond them is none of them.
        assert_eq!(with(10, 300.0).len(), 1, "seed {seed}: far beyond ten");
    }
}

#[test]
fn single_samples_beside_missing_ones_are_no_shocks() {
    for seed in 50..53 {
        let mut values = noise(seed);
        let len = values.len();
        for (n, place) in spread(len, 8).enumerate() {
            values[place] += 20.0;
            // Beside some on one side, beside some on both.
            values[place + 1] = f64::NAN;
            if n % 2 == 0 {
                values[place - 1] = f64::NAN;
            }
        }
        // So many are missing that gaps are looked across.
        for n in (0..len).step_by(7) {
            values[n] = if values[n].abs() > 10.0 {
                values[n]
            } else {
                f64::NAN
            };
        }
        assert!(told(values).is_empty(), "seed {seed}");
    }
}

#[test]
fn shocks_are_told_once_and_not_where_they_were_refused() {
    let mut values = noise(60);
    add(&mut values, &[ringing(100.0, 30.0)]);
    let mut trial = Trial::new(values);
    assert!(!trial.ask(&DETECTOR).is_empty(), "seed 60");
    trial.refuse(KIND);
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 60: refused");
    trial.refused.clear();
    let nothing = Change::Happened {
        masked: Vec::new(),
        waves: Vec::new(),
    };
    trial.know(KIND, [100.0, 30.0, 1.0, 7.3, 0.4], nothing);
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 60: known");
}

#[test]
fn a_bump_among_many_more_jumps_is_two_of_them() {
    let with = |jumps: usize, peak: f64| {
        let mut values = noise(61);
        let height = |n: usize| if n.is_multiple_of(2) { 30.0 } else { -30.0 };
        let places = spread(values.len(), jumps).enumerate();
        let jumps: Vec<_> = places.map(|(n, at)| trial::jump(at, height(n))).collect();
        trial::add(&mut values, &Wave::Steps(jumps));
        add(&mut values, &[bump(111.0, peak, 0.3)]);
        told(values).len()
    };
    assert_eq!(with(2, 15.0), 1, "seed 61: beside two");
    assert_eq!(with(7, 15.0), 0, "seed 61: beside seven");
    // What stands out far beyond them is none of them.
    assert_eq!(with(7, 1000.0), 1, "seed 61: far beyond seven");
}

#[test]
fn plain_and_faint_shocks_are_told_unless_they_are_many() {
    let mut few = noise(62);
    add(&mut few, &[ringing(50.0, 12.0), ringing(100.0, 1e4)]);
    assert_eq!(told(few).len(), 2, "seed 62");
}
