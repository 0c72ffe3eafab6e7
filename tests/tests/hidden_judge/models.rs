//! Models held against the truth and against what was held out.

use std::collections::BTreeMap;
use std::time::Duration;

use inm_tests::hidden::case::{Case, Files, Plan};
use inm_tests::hidden::effect::{self, find};
use inm_tests::hidden::judge::allan::{ModelError, Sides};
use inm_tests::hidden::judge::allan_table::{Mean, table};
use inm_tests::hidden::judge::answer::{
    Answer, Axis, Finding, Held, Interval, Last, Modelled, Remark, Views,
};
use inm_tests::hidden::judge::place::is_right;
use inm_tests::hidden::judge::program::{Diagnose, Failure, Outcome, Program};
use inm_tests::hidden::judge::score::{Score, score};
use inm_tests::hidden::judge::tally;
use inm_tests::hidden::judge::trial::{Task, Trial, run_all};
use inm_tests::hidden::outside::{self, Place};
use inm_tests::hidden::strength::Strength;
use inm_tests::hidden::truth::Truth;
use serde_json::json;

use super::{SAMPLES, plan};

/// Models whose deviations are 1.5 and 1.02 times the truth, on a part where 0.9 of it was measured.
fn off(case: &Case) -> Views {
    let ms = [1, 8, 64];
    let truth = case.allan_variances(&ms).expect("a law");
    let mut views = Views::default();
    for (m, variance) in ms.into_iter().zip(truth) {
        let models = |factor: f64| Modelled {
            m,
            before: 1.5 * factor * variance.sqrt(),
            after: 1.02 * factor * variance.sqrt(),
        };
        views.allan.push(models(1.0));
        views.held_out.push(Held {
            tau_s: m as f64 / 2000.0,
            adev: 0.9 * variance.sqrt(),
            edf: if m < 64 { 1000.0 } else { 999.0 },
            models: models(0.9),
        });
    }
    views
}

#[test]
fn models_are_held_against_the_truth_and_what_was_held_out() {
    for kind in ["markov", "steps", "burst", "rolloff", "outliers"] {
        let case = Case::draw(&plan(&[kind]), 1);
        let mut answer = perfect(&case);
        answer.axes[case.scene.target].views = off(&case);
        let errors = score(&case, &answer).allan;
        let ms: Vec<u64> = errors.iter().map(|one| one.m).collect();
        assert_eq!(ms, [1, 8], "{kind}: 999 degrees of freedom are too few");
        for one in errors {
            let truth = one.truth.expect("a law");
            for (sides, what) in [(truth, "truth"), (one.held_out, "held out")] {
                assert!(
                    (sides.before - 50.0).abs() < 1e-9,
                    "{kind}, {what}: {sides:?}"
                );
                assert!(
                    (sides.after - 2.0).abs() < 1e-9,
                    "{kind}, {what}: {sides:?}"
                );
            }
        }
        // What is named wrong has another fault than this.
        answer.axes[case.scene.target].findings[0].effect = "powerlaw".to_owned();
        assert!(score(&case, &answer).allan.is_empty(), "{kind}");
    }
}

#[test]
fn means_have_their_standard_error() {
    let mean = Mean::of(&[-1.0, 3.0, 4.0]).expect("three");
    // Squares about the mean add up to 14; over 2 and over 3.
    let error = (14.0_f64 / 6.0).sqrt();
    assert_eq!((mean.count, mean.mean), (3, 2.0));
    assert!((mean.error - error).abs() < 1e-12, "{mean:?}");
    assert!((mean.size - 8.0 / 3.0).abs() < 1e-12, "{mean:?}");
    assert!((mean.beyond() - (1.0 - error)).abs() < 1e-12, "{mean:?}");
    assert!(Mean::of(&[]).is_none());
    assert!(
        Mean::of(&[50.0]).expect("one").beyond() < 0.0,
        "one says nothing"
    );
}

/// Two kinds: one is off by 2 % at one averaging time, the other has no law there.
#[test]
fn the_table_marks_what_is_off() {
    let sides = |after: f64| Sides { before: 7.0, after };
    let trial = |row: &str, errors: &[(u64, Option<f64>)]| Trial {
        row: row.to_owned(),
        seed: 1,
        strength: None,
        ideal_power: None,
        facts: Vec::new(),
        redrawn: 0,
        result: Ok((
            Score {
                allan: errors
                    .iter()
                    .map(|&(m, truth)| ModelError {
                        m,
                        tau_s: m as f64,
                        truth: truth.map(sides),
                        held_out: sides(if m == 1 { 0.6 } else { 0.5 }),
                    })
                    .collect(),
                ..Score::default()
            },
            Duration::ZERO,
        )),
    };
    let trials = [
        trial("markov", &[(1, Some(0.9)), (2, Some(-2.0))]),
        trial("markov", &[(1, Some(1.0)), (2, Some(-2.2))]),
        trial("quantisation", &[(2, None)]),
    ];
    let text = table(&trials);
    let rows: Vec<Vec<&str>> = text
        .lines()
        .map(|line| line.split_whitespace().collect())
        .collect();
    let row = |name: &str| {
        let found = rows.iter().find(|row| row.first() == Some(&name));
        found
            .unwrap_or_else(|| panic!("no row {name} in\n{text}"))
            .join(" ")
    };
    assert_eq!(
        row("1.0000"),
        "1.0000 2 7.00 0.95 0.05 0.95 2 7.00 0.60 0.00 worst over the held-out part"
    );
    assert_eq!(
        row("2.0000"),
        "2.0000 2 7.00 -2.10 0.10 2.10 3 7.00 0.50 0.00 beyond 1 % worst over the truth"
    );
    assert_eq!(
        row("markov"),
        "markov 2.0000 2 7.00 -2.10 0.10 2.10 beyond 1 %"
    );
    assert_eq!(row("quantisation"), "quantisation -");
}
