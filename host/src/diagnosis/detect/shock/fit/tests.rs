//! The likeliest shock is found from where it is sought.

use super::*;
use crate::diagnosis::detect::shock::about::Beside;
use crate::diagnosis::detect::trial::noise;

#[test]
fn what_is_damped_more_than_critically_does_not_ring() {
    let values = noise(1);
    let beside = Beside {
        values: &values,
        quiet: &[0..5000, 5400..10_000],
        faint: 0.0,
    };
    let about = About::new(&beside, &(5000..5400), &(5000..5400), 1).expect("noise beside it");
    // A quality of a half is a decay of 1.6 samples at 0.1 cycles a sample.
    let score = |decay: f64| score(&about, Form::Ringing, &[5100.0, 0.1_f64.ln(), decay.ln()]);
    assert!(score(1.7).is_finite() && score(1.5).is_infinite(), "seed 1");
}

#[test]
fn half_a_turn_off_is_not_the_top() {
    for seed in 2..5 {
        let mut values = noise(seed);
        let shock = Shock {
            time_s: 5100.0,
            peak: 50.0,
            duration_s: f64::INFINITY,
            f_hz: 0.1,
            decay_s: 60.0,
        };
        shock.add_to(0, &mut values, 1.0);
        let beside = Beside {
            values: &values,
            quiet: &[0..5000, 5600..10_000],
            faint: 0.0,
        };
        let about = About::new(&beside, &(5050..5500), &(5000..5550), 1);
        let about = about.expect("noise beside it");
        let logs = [shock.f_hz.ln(), shock.decay_s.ln()];
        for aside in [-10.0, -5.0, 5.0, 10.0] {
            let first = settle(&about, Form::Ringing, &[5100.0 + aside, logs[0], logs[1]]);
            let found = on_its_turn(&about, first.expect("ringing"));
            let off = found.shock.time_s - shock.time_s;
            assert!(off.abs() < 0.5, "seed {seed}, {aside}: {off}");
        }
    }
}
