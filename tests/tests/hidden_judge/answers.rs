//! When an answer is right: names, places, parameters within their intervals.

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

use super::{finding, perfect, plan};

#[test]
fn a_perfect_answer_is_right_for_every_kind() {
    for kind in effect::KINDS {
        let case = Case::draw(&plan(&[kind.name]), 1);
        let score = score(&case, &perfect(&case));
        assert!(score.is_right(), "{}: {score:?}", kind.name);
        for parameter in &score.parameters {
            assert_eq!(parameter.inside, Some(true), "{}: {parameter:?}", kind.name);
        }
        // N is in its interval, and nothing is said of K. With a wrong rate neither is judged.
        let judged: Vec<Option<bool>> = score.coefficients.iter().map(|c| c.inside).collect();
        if kind.name == "timebase" {
            assert!(judged.is_empty());
        } else {
            assert_eq!(
                judged,
                [None, None, None, Some(true), None],
                "{}",
                kind.name
            );
        }
    }
}

#[test]
fn silence_and_wrong_names_are_wrong() {
    let case = Case::draw(&plan(&["markov"]), 1);
    let silent = Answer {
        axes: vec![Axis::default()],
    };
    assert!(!score(&case, &silent).is_named());
    let mut wrong = perfect(&case);
    wrong.axes[0].findings[0].effect = "telegraph".to_owned();
    let wrong = score(&case, &wrong);
    assert!(!wrong.is_named());
    assert_eq!(wrong.extra, ["telegraph"]);
    // Named twice is once too often.
    let mut twice = perfect(&case);
    let again = twice.axes[0].findings[0].clone();
    twice.axes[0].findings.push(again);
    assert_eq!(score(&case, &twice).extra, ["markov"]);
    // Named, but with a remark left: named, not right.
    let mut remark = perfect(&case);
    remark.axes[0]
        .unexplained
        .push(Remark(json!({"test": "x"})));
    let remark = score(&case, &remark);
    assert!(remark.is_named() && !remark.is_right());
}

#[test]
fn a_line_elsewhere_is_another_line() {
    let case = Case::draw(&plan(&["sinusoid"]), 1);
    let mut answer = perfect(&case);
    let parameters = &mut answer.axes[0].findings[0].parameters;
    let f_hz = parameters.get_mut("f_hz").expect("its frequency");
    f_hz.value = f_hz.value.map(|f_hz| 1.1 * f_hz);
    assert!(!score(&case, &answer).is_named());
}

#[test]
fn errors_are_counted_in_deviations() {
    let case = Case::draw(&plan(&["sinusoid"]), 1);
    let mut answer = perfect(&case);
    let amplitude = case.truths[0].parameter("amplitude").expect("known");
    let interval = Interval {
        value: Some(amplitude + 3.0),
        lo: Some(amplitude + 3.0 - 1.96),
        hi: Some(amplitude + 3.0 + 1.96),
        upper: None,
    };
    let parameters = &mut answer.axes[0].findings[0].parameters;
    parameters.insert("amplitude".to_owned(), interval);
    let score = score(&case, &answer);
    let said = &score.parameters[1];
    assert_eq!(said.inside, Some(false));
    let deviations = said.deviations.expect("an interval");
    assert!((deviations - 3.0).abs() < 1e-9, "{deviations}");
}

#[test]
fn places_are_read_from_words() {
    let remark = |text: &str| Remark(json!({"test": "lines", "where": text}));
    for (text, place, right) in [
        ("120 to 140 Hz, wanders", Place::Band(125.0, 135.0), true),
        ("near 0.13 kHz", Place::Band(125.0, 135.0), true),
        ("120-140 Hz after 3 s", Place::Band(200.0, 220.0), false),
        ("from 120 s to 140 s", Place::Band(125.0, 135.0), false),
        ("variance over 0.5 s", Place::Variance, true),
        ("skewed", Place::Amplitude, true),
        ("120 Hz", Place::Amplitude, false),
    ] {
        let remark = remark(text);
        assert_eq!(is_right(&[&remark], place), right, "{text}");
    }
    let structured = Remark(json!({"where": {"from_hz": 121.5, "to_hz": 130}}));
    assert!(is_right(&[&structured], Place::Band(125.0, 135.0)));
}

/// What has no name is right when a remark says where, and wrong when it is named.
#[test]
fn outside_the_catalogue_no_name_is_right() {
    let case = Case::draw(&plan(&["beating_tone"]), 1);
    let f_hz = case.truths[0].parameter("f_hz").expect("known");
    let mut answer = Answer {
        axes: vec![Axis::default()],
    };
    assert_eq!(score(&case, &answer).placed, Some(false));
    let words = format!("power near {f_hz:.1} Hz that wanders");
    answer.axes[0].unexplained.push(Remark(json!(words)));
    let good = score(&case, &answer);
    assert_eq!((good.placed, good.is_named()), (Some(true), true));
    let name = Truth::new("resonance", &[]);
    answer.axes[0].findings.push(finding(&name, 0));
    assert_eq!(score(&case, &answer).extra, ["resonance"]);
}
