//! A tone that has a name beside what a model lacks.

use super::*;
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::trial::line;
use crate::model::wander::Wander;
use crate::model::wandering_line::{self, WanderingLine};
use crate::model::{Seed, Term, sinusoid};

/// Amplitude of the tone that is there.
const AMPLITUDE: f64 = 1.0;

/// An axis with a tone at 150 Hz that wanders by 5 Hz within `wander_s`, named with `named` times its amplitude, beside
/// noise without a name that rings with a deviation of `lacks`.
fn with_tone(seed: u64, wander_s: f64, named: f64, lacks: f64) -> AxisState {
    let tone = WanderingLine {
        f_hz: 150.0,
        wander: Wander {
            rms_hz: 5.0,
            time_s: wander_s,
        },
        amplitudes: vec![AMPLITUDE],
    };
    let mut wanders = vec![0.0; long(seed)];
    let random = Seed { seed, stream: 10 };
    tone.generator(RATE_HZ, random).add_to(&mut wanders);
    let mut rings = ringing(seed, 0.3 * RATE_HZ, 0.03 * RATE_HZ);
    let make = |n: usize, noise| noise + wanders[n] + lacks * rings();
    let mut axis = axis(seed, wanders.len(), make);
    let values = [150.0, 5.0, wander_s, named * AMPLITUDE];
    let effect = Estimate::new(wandering_line::KIND, values.map(Value::exact));
    let change = Change::Tone(vec![120.0..180.0]);
    let candidate = Candidate::new(effect, 1e-9, 1.0, change);
    axis.accept(candidate).expect("a fit beside it");
    axis
}

#[test]
fn a_tone_of_another_size_than_it_was_named_with_is_taken_back() {
    for seed in 30..32 {
        let left = |named: f64| {
            let mut axis = with_tone(seed, 0.1, named, 1.0);
            let completed = complete(&mut axis, LEVEL);
            assert!(completed.p_value.is_some(), "seed {seed}, {named}");
            axis.kinds()
        };
        assert_eq!(left(1.0), [wandering_line::KIND], "seed {seed}");
        assert_eq!(left(3.0), [], "seed {seed}");
    }
}

#[test]
fn a_tone_beside_what_is_missing_keeps_the_size_that_was_measured() {
    for seed in 32..34 {
        let mut axis = with_tone(seed, 0.1, 1.1, 1.0);
        assert!(complete(&mut axis, LEVEL).p_value.is_some(), "seed {seed}");
        let of_tone = axis.explanations()[0].effect.plain();
        let found = of_tone[wandering_line::FIRST_AMPLITUDE];
        assert_eq!(found, 1.1 * AMPLITUDE, "seed {seed}");
    }
}

#[test]
fn a_tone_that_wandered_a_few_times_is_not_held_to_its_law() {
    for seed in 34..38 {
        let mut axis = with_tone(seed, 10.0, 1.0, 0.0);
        complete(&mut axis, LEVEL);
        assert_eq!(axis.kinds(), [wandering_line::KIND], "seed {seed}");
    }
}

#[test]
fn a_line_within_what_is_missing_stays_where_it_is_known_beside_it() {
    for seed in 38..42 {
        let left = |size: f64| {
            let mut rings = ringing(seed, 0.3 * RATE_HZ, 0.003 * RATE_HZ);
            let mut axis = axis(seed, long(seed), |_, noise| noise + rings());
            let f_hz = 0.3 * RATE_HZ;
            let effect = Estimate::new(sinusoid::KIND, [f_hz, size].map(Value::exact));
            let wave = Change::Waves(vec![line(f_hz, size)]);
            axis.accept(Candidate::new(effect, 1e-9, 1.0, wave))
                .expect("a fit");
            assert!(complete(&mut axis, LEVEL).p_value.is_some(), "seed {seed}");
            axis.kinds()
        };
        // Of forty thousand samples a line of three hundredths is known in white noise of this size, and not within what rings
        // with as much.
        assert_eq!(left(1.0), [sinusoid::KIND], "seed {seed}");
        assert_eq!(left(0.03), [], "seed {seed}");
    }
}
