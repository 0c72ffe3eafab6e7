//! `inm diagnose` says what it said before, of every sort of record.
//!
//! What it said stands in `tests/frozen`; where it is meant to say something else now, see
//! [`RENEW`].

use std::collections::BTreeSet;
use std::fs;

use inm_tests::hidden::frozen::answer;
use inm_tests::hidden::frozen::compare::{Difference, differences};
use inm_tests::hidden::frozen::program::{Bench, absolute, ask, frozen_folder};
use inm_tests::hidden::frozen::record::Frozen;
use inm_tests::hidden::frozen::records::{NOT_YET, is_frozen, records};
use inm_tests::hidden::judge::program::Program;
use serde_json::{Value, json};

/// How to freeze anew.
const RENEW: &str = "if it is meant to say so from now on: cargo build --release -p inm-host && \
                     cargo run --release -p inm-tests --example frozen -- --renew";

/// Differences that are shown of a record: the first says where to look.
const SHOWN: usize = 3;

/// Records at once; most of a diagnosis runs on one processor.
const AT_ONCE: usize = 2;

#[test]
fn the_diagnosis_says_what_it_said_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let bench = Bench {
        inm: Program::built().0,
        records: absolute(folder.path()).expect("there"),
        answers: absolute(folder.path()).expect("there"),
    };
    let mut records = records();
    records.retain(|record| is_frozen(record.name()));
    let answers = ask(&records, &bench, AT_ONCE, &|_, _| {});
    let mut failures = Vec::new();
    for (record, answer) in records.iter().zip(answers) {
        let name = record.name();
        let differ = match answer {
            Ok(()) => differ(record, &bench),
            Err(failure) => vec![failure.to_string()],
        };
        let shown = differ.iter().take(SHOWN);
        failures.extend(shown.map(|difference| format!("{name}: {difference}")));
        if differ.len() > SHOWN {
            failures.push(format!("{name}: and {} more", differ.len() - SHOWN));
        }
    }
    assert!(
        failures.is_empty(),
        "the diagnosis does not say what it said before:\n{}\n{RENEW}",
        failures.join("\n")
    );
}

/// What differs from what was frozen, beyond another machine's rounding.
fn differ(record: &Frozen, bench: &Bench) -> Vec<String> {
    let name = record.name();
    let before = answer::read(name, &frozen_folder().join(format!("{name}.json")));
    let (before, now) = match (before, answer::read(name, &bench.answer(name))) {
        (Ok(before), Ok(now)) => (before, now),
        (Err(error), _) | (_, Err(error)) => return vec![error.to_string()],
    };
    let mut all = differences(&before, &now);
    all.retain(|difference| difference.times > 1.0);
    all.iter().map(Difference::to_string).collect()
}

#[test]
fn every_record_is_frozen_or_listed_and_nothing_else_is() {
    let names: BTreeSet<String> = records().iter().map(|one| one.name().to_owned()).collect();
    assert_eq!(names.len(), records().len(), "a name is there twice");
    for (name, why) in NOT_YET {
        assert!(names.contains(name), "{name} ({why}) is no record");
    }
    let files = fs::read_dir(frozen_folder()).expect("the folder is there");
    let frozen: BTreeSet<String> = files
        .map(|file| {
            file.expect("readable")
                .file_name()
                .into_string()
                .expect("text")
        })
        .filter_map(|file| file.strip_suffix(".json").map(str::to_owned))
        .collect();
    let expected: BTreeSet<String> = names.into_iter().filter(|name| is_frozen(name)).collect();
    assert_eq!(frozen, expected, "{RENEW}");
}

/// An answer with one finding.
fn said(f_hz: f64, p_value: f64) -> Value {
    json!({ "source": { "samples": 100 }, "axes": [ { "findings": [ { "effect": "hum",
        "parameters": { "f_hz": { "value": f_hz, "lo": 49.99, "hi": 50.01 } },
        "p_value": p_value } ] } ] })
}

#[track_caller]
fn is_the_same(before: &Value, now: &Value, expected: bool) {
    let found = differences(before, now);
    let same = found.iter().all(|difference| difference.times <= 1.0);
    assert_eq!(same, expected, "{found:?}");
}

#[test]
fn a_number_may_move_by_a_small_part_of_its_interval_and_no_more() {
    let before = said(50.0, 1e-20);
    // The tolerance is the larger of 3e-5 of the width and 1e-9 of the number: 6e-7 here.
    is_the_same(&before, &said(50.0 + 5.9e-7, 1e-20), true);
    is_the_same(&before, &said(50.0 + 6.1e-7, 1e-20), false);
}

#[test]
fn p_values_are_compared_by_their_logarithms() {
    is_the_same(&said(50.0, 1e-20), &said(50.0, 1e-21), true);
    is_the_same(&said(50.0, 1e-10), &said(50.0, 1.001e-10), false);
    is_the_same(&said(50.0, 1e-300), &said(50.0, 0.0), true);
    is_the_same(&said(50.0, 1e-3), &said(50.0, 0.0), false);
}

#[test]
fn another_name_another_field_and_another_count_are_differences() {
    let before = said(50.0, 1e-20);
    let mut now = before.clone();
    now["axes"][0]["findings"][0]["effect"] = json!("sinusoid");
    let found = differences(&before, &now);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].path, "axes[0].findings[0].effect");
    let mut now = before.clone();
    now["axes"][0]["findings"] = json!([]);
    is_the_same(&before, &now, false);
    let mut now = before.clone();
    now["axes"][0]["more"] = json!(1);
    is_the_same(&before, &now, false);
    let mut now = before.clone();
    now["source"]["samples"] = json!(101);
    is_the_same(&before, &now, false);
}
