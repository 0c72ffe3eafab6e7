//! A shock is found across gaps, however long it rings, and on a walk.

use super::*;
use crate::diagnosis::trial::numbers;

/// Whether one shock is told, near its moment and frequency.
fn is_told(found: &[Shock], shock: &Shock) -> bool {
    let is_near = |one: &Shock| {
        (one.time_s - shock.time_s).abs() < 0.02 && (one.f_hz / shock.f_hz - 1.0).abs() < 0.02
    };
    found.len() == 1 && is_near(&found[0])
}

#[test]
fn a_shock_is_told_by_what_was_measured_of_it() {
    for (seed, every) in (70..).zip([3, 7, 25]) {
        let mut values = noise(seed);
        let shock = ringing(100.123, 100.0);
        add(&mut values, &[shock]);
        values
            .iter_mut()
            .skip(1)
            .step_by(every)
            .for_each(|one| *one = f64::NAN);
        let found = told(values);
        assert!(is_told(&found, &shock), "seed {seed}, {every}: {found:?}");
    }
}

#[test]
fn what_rings_for_thousands_of_samples_is_a_shock() {
    let mut values: Vec<f64> = (80..84).flat_map(noise).collect();
    let shock = Shock {
        decay_s: 9.0,
        f_hz: 31.0,
        ..ringing(300.123, 1000.0)
    };
    add(&mut values, &[shock]);
    let found = told(values);
    assert!(is_told(&found, &shock), "seeds 80 to 83: {found:?}");
}

#[test]
fn ringing_on_a_walk_is_no_jump() {
    for seed in 90..95 {
        let mut values: Vec<f64> = (0..2).flat_map(|n| noise(seed + 10 * n)).collect();
        let mut normal = numbers(seed, 4);
        let mut level = 0.0;
        for value in &mut values {
            level += 10.0 * normal.draw();
            *value += level;
        }
        let shock = Shock {
            decay_s: 4.0,
            f_hz: 31.0,
            ..ringing(200.123, 150.0)
        };
        add(&mut values, &[shock]);
        let found = told(values);
        assert!(is_told(&found, &shock), "seed {seed}: {found:?}");
    }
}
