//! The likeliest shock is found from where it is sought.

use super::*;
use crate::diagnosis::detect::shock::trial::{EVENT, about, ringing};
use crate::diagnosis::detect::trial::noise;

#[test]
fn what_is_damped_more_than_critically_does_not_ring() {
    let about = about(&noise(1));
    // A quality of a half is a decay of 1.6 samples at 0.1 cycles a sample.
    let time = EVENT.start as f64;
    let score = |decay: f64| score(&about, Form::Ringing, &[time, 0.1_f64.ln(), decay.ln()]);
    assert!(score(1.7).is_finite() && score(1.5).is_infinite(), "seed 1");
}

#[test]
fn half_a_turn_off_is_not_the_top() {
    for seed in 2..5 {
        let mut values = noise(seed);
        let shock = ringing(9020.0, 50.0, 0.1, 60.0);
        shock.add_to(0, &mut values, 1.0);
        let about = about(&values);
        let logs = [shock.f_hz.ln(), shock.decay_s.ln()];
        for aside in [-10.0, -5.0, 5.0, 10.0] {
            let at = [shock.time_s + aside, logs[0], logs[1]];
            let first = settle(&about, Form::Ringing, &at);
            let found = on_its_turn(&about, first.expect("ringing"));
            let off = found.shock.time_s - shock.time_s;
            assert!(off.abs() < 0.5, "seed {seed}, {aside}: {off}");
        }
    }
}
