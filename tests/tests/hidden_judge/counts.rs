//! Tables of what was named and what an ideal detector would see.

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

use super::plan;

/// A stand-in that reads nothing and says the same of every record.
struct Parrot;

impl Diagnose for Parrot {
    fn diagnose(&self, files: &Files) -> Result<Outcome, Failure> {
        let bytes = std::fs::read(&files.record)?;
        assert_eq!(bytes.len() % 8, 0, "a header of whole words, and float64");
        let answer = json!({"axes": [{"findings": [{"effect": "markov", "parameters": {}}],
                                       "unexplained": []}]});
        Ok(Outcome {
            answer: serde_json::from_value(answer)?,
            time: Duration::from_millis(10),
        })
    }
}

#[test]
fn tables_count_what_was_said() {
    let tasks: Vec<Task> = [plan(&["markov"]), plan(&["rolloff"]), plan(&[])]
        .into_iter()
        .flat_map(|plan| {
            (1..=2).map(move |seed| Task {
                plan: plan.clone(),
                seed,
            })
        })
        .collect();
    let trials = run_all(&tasks, &Parrot, 2, &|_| {});
    let named: Vec<bool> = trials
        .iter()
        .map(|trial| {
            trial
                .result
                .as_ref()
                .is_ok_and(|(score, _)| score.is_right())
        })
        .collect();
    assert_eq!(named, [true, true, false, false, false, false]);
    let table = tally::confusion(&trials);
    assert!(table.contains("rolloff                markov 2"), "{table}");
    assert!(table.contains("clean                  markov 2"), "{table}");
}

#[test]
fn detection_stands_beside_the_ideal() {
    let trial = |row: &str, strength: f64, ideal: f64, named: Option<bool>| Trial {
        row: row.to_owned(),
        seed: 1,
        strength: Some(strength),
        ideal_power: Some(ideal),
        facts: Vec::new(),
        redrawn: 0,
        result: match named {
            Some(named) => Ok((
                Score {
                    named: vec![("hum", true), ("steps", named)],
                    // Another name beside it does not make it less seen.
                    extra: vec!["burst".to_owned()],
                    ..Score::default()
                },
                Duration::ZERO,
            )),
            None => Err(Failure::Status("2".to_owned(), String::new())),
        },
    };
    let trials = [
        trial("steps", 1.5, 1.0, Some(true)),
        trial("steps", 0.3, 0.2, Some(false)),
        trial("steps", 0.3, 0.4, Some(true)),
        trial("burst", 0.3, 0.0, Some(false)),
        trial("burst", 0.3, 0.1, None),
    ];
    let text = tally::detection(&trials);
    let rows: Vec<String> = text
        .lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    let expected = [
        "named % (ideal %)",
        "strength 0.30 1.50",
        "steps 50 (30) 100 (100)",
        "burst 0 (5) -",
        "all 25 (18) 100 (100)",
    ];
    assert_eq!(rows, expected, "{text}");
}
