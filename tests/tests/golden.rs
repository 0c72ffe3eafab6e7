//! What a release wrote stays readable, and says the same.

use std::collections::BTreeSet;
use std::mem::discriminant;
use std::path::Path;
use std::process::{Command, Output};

use inm_host::ExportInput as Input;
use inm_host::Model;
use inm_host::internals::model::catalogue::CATALOGUE;
use inm_host::{Coefficient, PerCoefficient};
use inm_protocol::{Decoder, Note, ToHost};
use inm_tests::golden::{json, law, path};
use inm_tests::hidden::frozen::compare::{Difference, differences};
use inm_tests::hidden::judge::program::Program;
use serde_json::Value;

/// Models and what they mean. One with a new effect is a new file and a line here.
const MODELS: [[&str; 2]; 7] = [
    ["model.json", "law.json"],
    ["cyclic.model.json", "cyclic.law.json"],
    ["unnamed.model.json", "unnamed.law.json"],
    ["drift.model.json", "drift.law.json"],
    ["averaging.model.json", "averaging.law.json"],
    ["held.model.json", "held.law.json"],
    ["highpass.model.json", "highpass.law.json"],
];

/// Captures and what was said of them, by the version of the protocol.
const CAPTURES: [[&str; 2]; 2] = [
    ["board.inmcap", "board.json"],
    ["board-2.inmcap", "board-2.json"],
];

fn inm(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(Program::built().0);
    let output = command.current_dir(folder).args(arguments).output();
    let output = output.expect("inm runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
    output
}

/// Not beyond another machine's rounding.
#[track_caller]
fn assert_same(before: &Value, now: &Value) {
    let mut all = differences(before, now);
    all.retain(|difference| difference.times > 1.0);
    let all: Vec<String> = all.iter().map(Difference::to_string).collect();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn a_capture_of_then_is_analysed_as_it_was_then() {
    for [capture, said] in CAPTURES {
        let output = inm(&path(""), &["analyze", capture, "--json", "-"]);
        let mut now: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let then = json(&path(said));
        // Fields that came since the first: what was missing of single axes, and the rate by the stamps; its
        // uncertainty came later than both.
        let source = now["source"].as_object_mut().expect("an object");
        let clocks = source.remove("clocks").expect("both have stamps");
        assert_eq!(
            clocks["rate_by_board_hz"]["value"],
            source["measured_rate_hz"]
        );
        for field in ["unusable", "measured_rate_hz"] {
            assert!(!source[field].is_null(), "{field}");
            if then["source"].get(field).is_none() {
                assert_eq!(capture, "board.inmcap", "{field}");
                source.remove(field);
            }
        }
        // It is worth something only if much has happened.
        assert!(then["source"]["lost_samples"].as_u64() > Some(0));
        assert!(then["axes"][0]["invalid_samples"].as_u64() > Some(0));
        assert_same(&then, &now);
    }
}

#[test]
fn every_message_of_the_captures_but_the_damaged_is_understood() {
    for (version, [capture, _]) in (1..).zip(CAPTURES) {
        understood(version, &std::fs::read(path(capture)).expect("there"));
    }
}

/// Nearly every message of a capture, which has all kinds of them, in frames of this version.
fn understood(version: u8, capture: &[u8]) {
    let header = capture
        .iter()
        .enumerate()
        .filter(|(_, byte)| **byte == b'\n');
    let (end, _) = header.take(2).last().expect("two lines");
    let mut frames = &capture[end + 1..];
    let mut decoder: Decoder = Decoder::default();
    let (mut messages, mut damaged) = (Vec::new(), 0);
    while let Some(message) = decoder.next::<ToHost>(&mut frames) {
        match message {
            Ok(message) => messages.push(message),
            Err(_) => damaged += 1,
        }
    }
    // One bit was flipped, and the port vanished within a frame and came back within another.
    assert!((1..=3).contains(&damaged), "{damaged} frames are damaged");
    assert_eq!(decoder.version(), Some(version));
    let kinds: Vec<_> = messages.iter().map(discriminant).collect();
    let of = |kind: fn(&ToHost) -> bool| messages.iter().find(|one| kind(one));
    for one in [
        of(|one| matches!(one, ToHost::Samples(_))),
        of(|one| matches!(one, ToHost::Health(_))),
        of(|one| matches!(one, ToHost::Reply(_))),
        of(|one| matches!(one, ToHost::Event(_))),
        of(|one| matches!(one, ToHost::Note(Note::PortLost { .. }))),
        of(|one| matches!(one, ToHost::Note(Note::PortBack { .. }))),
        of(|one| matches!(one, ToHost::Note(Note::End { .. }))),
    ] {
        assert!(one.is_some(), "a kind of message is missing: {kinds:?}");
    }
}

#[test]
fn a_model_of_then_has_every_effect_and_the_same_law() {
    let mut effects = BTreeSet::new();
    for [model_file, law_file] in MODELS {
        let name = path(model_file).display().to_string();
        let model = Model::open(&name).unwrap_or_else(|error| panic!("{error}"));
        let here = model.axes.iter().flat_map(|axis| &axis.effects);
        effects.extend(here.map(|effect| effect.kind().name()));
        let written = serde_json::to_value(&model).expect("a model is JSON");
        assert_eq!(json(&path(model_file)), written, "{model_file}");
        assert_same(&json(&path(law_file)), &law(&model));
    }
    for effect in CATALOGUE {
        let name = effect.name();
        let new = "is in no model here; add files with it and its law, and name them in MODELS";
        assert!(effects.contains(name), "{name} {new}");
    }
}

#[test]
fn a_model_of_then_still_makes_data() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = path("model.json").display().to_string();
    let temperature: String = (0..600)
        .map(|i| format!("{}\n", 20.0 + 0.01 * f64::from(i)))
        .collect();
    std::fs::write(folder.path().join("t.csv"), temperature).expect("written");
    let length = ["--duration", "2", "--temperature", "t.csv"];
    let simulate = ["simulate", "--model", &model, "-o", "made.csv"];
    inm(folder.path(), &[&simulate[..], &length].concat());
    let made = std::fs::read_to_string(folder.path().join("made.csv")).expect("written");
    let rows: Vec<Vec<f64>> = made
        .lines()
        .map(|line| {
            line.split(',')
                .map_while(|one| one.trim().parse().ok())
                .collect()
        })
        .filter(|row: &Vec<f64>| !row.is_empty())
        .collect();
    // Two seconds at the model's rate; three axes and the temperature.
    assert_eq!(rows.len(), 500);
    assert!(rows.iter().all(|row| row.len() >= 4), "{:?}", rows[0]);
    // Clipped at 0.105: the top of the column is flat.
    let z = rows.iter().map(|row| row[row.len() - 2]);
    assert!(z.fold(f64::MIN, f64::max) <= 0.105 + 1e-4);
}

#[test]
fn a_diagnosis_of_then_is_the_model_that_was_written_beside_it() {
    let open = |name: &str| {
        let model = Model::open(&path(name).display().to_string());
        model.unwrap_or_else(|error| panic!("{error}"))
    };
    let (model, diagnosis) = (open("diagnosis.model.json"), open("diagnosis.json"));
    // One of them was once written by a program that read numbers a bit beside what was written.
    let [then, beside] =
        [diagnosis, model.clone()].map(|one| serde_json::to_value(one).expect("JSON"));
    assert_same(&beside, &then);
    assert!(!model.axes[0].effects.is_empty(), "it found something");
}

#[test]
fn an_analysis_of_then_is_a_model_to_export() {
    let name = path("analysis.json");
    let input = Input::open(&name.display().to_string());
    let input = input.unwrap_or_else(|error| panic!("{error}"));
    let fit = &json(&name)["axes"][0]["fits"]["likelihood"];
    let identified = |one: Coefficient| fit[one.symbol()]["identified"] == true;
    let told = |one: Coefficient| {
        fit[one.symbol()]["value"]
            .as_f64()
            .filter(|_| identified(one))
    };
    let expected = PerCoefficient::from_fn(|one| told(one).unwrap_or(0.0));
    assert_eq!(input.model.axes[0].coefficients, expected);
    assert!(expected.n > 0.0 && expected.q > 0.0, "{expected:?}");
}
