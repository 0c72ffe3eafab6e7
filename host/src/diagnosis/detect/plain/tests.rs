//! Courses that are plain, and what looks like one.

use std::f64::consts::TAU;

use super::*;
use crate::diagnosis::detect::trial::{self, RATE_HZ, Trial, noise};
use crate::diagnosis::trial::numbers;
use crate::model::kind::Kind;

/// What is proposed of noise with a course of the time in seconds.
fn proposed(seed: u64, course: impl Fn(f64) -> f64) -> Trial {
    let mut values = noise(seed);
    for (n, value) in values.iter_mut().enumerate() {
        *value += course(n as f64 / RATE_HZ);
    }
    Trial::new(values)
}

fn kinds(trial: &Trial) -> Vec<Kind> {
    trial::kinds(&trial.ask(&DETECTOR))
}

/// A heater that is on for this share of its period, behind a lag, from cold.
fn heater(period_s: f64, share: f64, lag_s: f64) -> impl Fn(f64) -> f64 {
    let level = move |at_s: f64| {
        // Of a first-order lag: what each switching so far has brought.
        let follow = |since_s: f64| {
            if since_s > 0.0 {
                1.0 - (-since_s / lag_s).exp()
            } else {
                0.0
            }
        };
        let turns = 0..=(at_s / period_s) as usize;
        let turn = |number: usize| {
            let since_s = at_s - number as f64 * period_s;
            follow(since_s) - follow(since_s - share * period_s)
        };
        turns.map(turn).sum::<f64>()
    };
    move |at_s| 100.0 * level(at_s)
}

#[test]
fn two_settlings_are_told_with_their_times_and_sizes() {
    for (seed, [quick, slow]) in [(1, [40.0, -90.0]), (2, [-120.0, -20.0]), (3, [25.0, 30.0])] {
        let course = |at_s: f64| quick * (-at_s / 4.0_f64).exp() + slow * (-at_s / 50.0_f64).exp();
        let trial = proposed(seed, course);
        let found = trial.ask(&DETECTOR);
        assert_eq!(trial::kinds(&found), [warmup::KIND; 2], "seed {seed}");
        for (one, [size, time_s]) in found.into_iter().zip([[quick, 4.0], [slow, 50.0]]) {
            let one = trial::candidate(vec![one]).expect("a settling");
            let values: Vec<_> = one.effect.values.into_iter().flatten().collect();
            // Five deviations of either number: the noise is told by parts of what is left.
            let off = (values[0].value - size) / values[0].sd();
            assert!(off.abs() < 5.0, "seed {seed}: {off} deviations of the size");
            let sd = (values[1].hi.expect("an end") / values[1].value).ln() / 1.96;
            let off = (values[1].value / time_s).ln() / sd;
            assert!(off.abs() < 5.0, "seed {seed}: {off} deviations of the time");
        }
    }
}

#[test]
fn a_switched_heater_is_a_cycle_with_a_settling() {
    for (seed, period_s, share, lag_s) in [(11, 21.3, 0.4, 6.0), (12, 33.0, 0.5, 9.0)] {
        let mut trial = proposed(seed, heater(period_s, share, lag_s));
        let found = trial.ask(&DETECTOR);
        assert_eq!(
            trial::kinds(&found),
            [warmup::KIND, hum::KIND],
            "seed {seed}"
        );
        let square = |values: &[f64]| {
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            values.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / count
        };
        let before = square(&trial.axis.residual.values());
        for one in found {
            trial.accept(trial::candidate(vec![one]).expect("a part of the course"));
        }
        // The noise is of deviation 1, with little beside it: of as many squares the mean scatters by a hundredth.
        let left = square(&trial.axis.residual.values());
        assert!(before > 100.0, "seed {seed}");
        assert!((left - 1.0).abs() < 0.05, "seed {seed}: {left} is left");
    }
}

#[test]
fn a_quick_heater_is_followed_to_the_multiples_that_coarse_means_do_not_show() {
    for (seed, turns, share) in [(13, 23.0, 0.5), (14, 28.5, 0.4)] {
        let values = noise(seed);
        let period_s = values.len() as f64 / RATE_HZ / turns;
        let course = heater(period_s, share, 0.05 * period_s);
        let trial = proposed(seed, |at_s| 300.0 * course(at_s));
        let found = trial.ask(&DETECTOR).into_iter();
        let cycle = found.filter_map(|one| trial::candidate(vec![one]));
        let cycle = cycle.max_by_key(|one| one.effect.values.len());
        let lines = cycle.expect("a cycle").effect.values.len();
        // Of 8192 means, of which a line has four a turn, there are fewer.
        assert!(lines as f64 > 8192.0 / 4.0 / turns, "seed {seed}: {lines}");
    }
}

#[test]
fn noise_that_hides_a_settling_hides_no_cycle() {
    for seed in [15, 16] {
        // A sixth of the noise's power is left in means of six samples, as many as tell the settling: more than a twentieth of what the
        // cycle has there. Of those that tell the cycle it is a five-hundredth.
        let course = heater(30.0, 0.5, 1.0);
        let at_s = |n: usize| n as f64 / RATE_HZ;
        let values = noise(seed).into_iter().enumerate();
        let values: Vec<f64> = values
            .map(|(n, value)| value + 0.02 * course(at_s(n)))
            .collect();
        let means = Means::new(&values);
        let course = Course {
            settlings: vec![RATE_HZ],
            cycle: Some(Cycle {
                cycles: (30.0 * RATE_HZ).recip(),
                multiples: 20,
            }),
        };
        let fitted = Fitted::new(&means, course).expect("parts that differ");
        assert!(is_plain(&means, &fitted), "seed {seed}");
    }
}

#[test]
fn settlings_as_slow_as_a_record_holds_are_measured_in_means_enough() {
    for seed in [4, 5] {
        let duration_s = noise(seed).len() as f64 / RATE_HZ;
        let course = |at_s: f64| {
            let settling = |share: f64| (-at_s / (share * duration_s)).exp();
            -300.0 * settling(0.16) + 200.0 * settling(0.38)
        };
        assert_eq!(
            kinds(&proposed(seed, course)),
            [warmup::KIND; 2],
            "seed {seed}"
        );
    }
    // The slowest cycle, with a settling.
    let duration_s = noise(6).len() as f64 / RATE_HZ;
    let trial = proposed(6, heater(duration_s / 5.4, 0.5, 0.06 * duration_s));
    let found = kinds(&trial);
    assert_eq!(found, [warmup::KIND, hum::KIND], "seed 6");
}

#[test]
fn a_slow_sine_is_one_line() {
    let trial = proposed(21, |at_s| 20.0 * (TAU * at_s / 17.0).sin());
    assert_eq!(kinds(&trial), [sinusoid::KIND], "seed 21");
}

#[test]
fn what_is_no_course_of_few_numbers_is_none() {
    type Level = Box<dyn Fn(f64) -> f64>;
    let none: [(&str, Level); 5] = [
        ("noise alone", Box::new(|_| 0.0)),
        ("one settling", Box::new(|at_s| 80.0 * (-at_s / 20.0).exp())),
        (
            "a jump",
            Box::new(|at_s| if at_s > 70.0 { 50.0 } else { 0.0 }),
        ),
        ("a parabola", Box::new(|at_s| 1e-2 * (at_s - 90.0).powi(2))),
        (
            "turns that slow down",
            Box::new(|at_s| 50.0 * (TAU * at_s / (15.0 + 0.05 * at_s)).sin()),
        ),
    ];
    for (seed, (what, course)) in (31..).zip(none) {
        assert_eq!(kinds(&proposed(seed, course)), [], "seed {seed}: {what}");
    }
}

#[test]
fn a_walk_and_flicker_go_no_such_way() {
    // Of 60 walks none is expected at one in 10^7.
    for seed in 100..160 {
        let (mut normal, mut level) = (numbers(seed, 0), 0.0);
        let walk = |_| {
            level += normal.draw();
            level
        };
        let trial = Trial::new((0..20_011).map(walk).collect());
        assert_eq!(kinds(&trial), [], "seed {seed}");
    }
    for seed in 200..220 {
        // Lags of a decade each and the same variance: flicker over five decades.
        let mut normal = numbers(seed, 0);
        let mut lags = [0.0; 6];
        let flicker = |_| {
            for (lag, keep) in lags
                .iter_mut()
                .zip([0.0, 0.9, 0.99, 0.999, 0.9999, 0.99999_f64])
            {
                *lag = keep * *lag + (1.0 - keep * keep).sqrt() * normal.draw();
            }
            lags.iter().sum::<f64>()
        };
        let trial = Trial::new((0..30_011).map(flicker).collect());
        assert_eq!(kinds(&trial), [], "seed {seed}");
    }
}

#[test]
fn beside_a_temperature_nothing_is_read_off() {
    let mut trial = proposed(41, |at_s| 20.0 * (TAU * at_s / 17.0).sin());
    trial.covariate = Some(crate::diagnosis::record::reading::Reading::exact(
        trial::covariate(trial.axis.residual.len()),
    ));
    assert_eq!(kinds(&trial), [], "seed 41");
}

#[test]
fn a_strong_line_is_no_multiple_of_what_it_leaves_at_gaps() {
    for (seed, f_hz) in [(71, 0.41), (72, 0.57)] {
        let mut values = noise(seed);
        for (n, value) in values.iter_mut().enumerate() {
            *value += 300.0 * (TAU * f_hz * n as f64 / RATE_HZ).cos();
        }
        values[6000..6013].fill(f64::NAN);
        values[14_000..14_017].fill(f64::NAN);
        let found = kinds(&Trial::new(values));
        assert!(!found.contains(&hum::KIND), "seed {seed}: {found:?}");
    }
}
