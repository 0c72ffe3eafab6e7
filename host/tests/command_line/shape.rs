//! The JSON of each command that writes any: which fields it has, and of which types. The numbers are judged
//! elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

use crate::{assert_all_of, inm, text};

/// A capture that is as old as the format.
const CAPTURE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/golden/board.inmcap");

/// The commands with `--json`, how each is run, and the exit status.
const CASES: [(&str, &[&str], i32); 11] = [
    ("analyze", &[CAPTURE], 0),
    (
        "diagnose",
        &["record.npy", "--rate", "2000", "--unit", "g"],
        0,
    ),
    (
        "live",
        &[
            "--source",
            "virtual",
            "--speed",
            "0",
            "--duration",
            "5",
            "--plain",
            "--no-record",
        ],
        0,
    ),
    ("replay", &[CAPTURE], 0),
    (
        "calibrate",
        &[
            "--port",
            "virtual",
            "--positions",
            "12",
            "--seconds",
            "2",
            "--seed",
            "3",
        ],
        0,
    ),
    ("board ports", &["virtual"], 0),
    ("board info", &["--port", "virtual"], 0),
    ("board selftest", &["--port", "virtual"], 0),
    ("board reset", &["--port", "virtual"], 0),
    ("board log", &["--port", "virtual", "--duration", "1"], 0),
    ("board update", &["--port", "virtual"], 0),
];

/// Types by the place of a value: `axes[].allan[].adev`.
type Shape = BTreeMap<String, BTreeSet<&'static str>>;

fn enter(value: &Value, place: &str, shape: &mut Shape) {
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "yes or no",
        Value::Number(_) => "number",
        Value::String(_) => "text",
        Value::Array(list) => {
            let place = format!("{place}[]");
            list.iter().for_each(|one| enter(one, &place, shape));
            "list"
        }
        Value::Object(fields) => {
            for (name, field) in fields {
                let place = if place.is_empty() {
                    name.clone()
                } else {
                    format!("{place}.{name}")
                };
                enter(field, &place, shape);
            }
            "object"
        }
    };
    shape.entry(place.to_owned()).or_default().insert(kind);
}

/// A line a field.
fn told(values: &[Value]) -> String {
    let mut shape = Shape::new();
    values.iter().for_each(|value| enter(value, "", &mut shape));
    let line = |(place, kinds): (&String, &BTreeSet<&str>)| {
        let kinds: Vec<&str> = kinds.iter().copied().collect();
        let place = if place.is_empty() { "all of it" } else { place };
        format!("{place}: {}\n", kinds.join(" or "))
    };
    shape.iter().map(line).collect()
}

/// JSON, one value or one a line; of ports only those that every machine has.
fn values(command: &str, json: &[u8]) -> Vec<Value> {
    let stream = serde_json::Deserializer::from_slice(json).into_iter();
    let mut values: Vec<Value> = stream.map(|value| value.expect("JSON")).collect();
    if command == "board ports" {
        let ports = values[0].as_array_mut().expect("a list");
        ports.retain(|port| port["name"] == "virtual");
        assert_eq!(ports.len(), 1);
    }
    values
}

/// A record with noise that no term of the five has, and a line.
fn record(folder: &Path) {
    let model = r#"{"schema": 1, "rate_hz": 2000, "axes": [{"name": "X", "unit": "m/s^2", "mean": 0,
        "chain": null, "coefficients": {"R": 0, "K": 0, "B": 0, "N": 1e-4, "Q": 0}, "effects": [
        {"effect": "sinusoid", "parameters": {"amplitude": 2e-3, "f_hz": 31}}]}]}"#;
    std::fs::write(folder.join("model.json"), model).expect("written");
    let arguments = [
        "simulate",
        "--model",
        "model.json",
        "--duration",
        "20",
        "-o",
        "record.npy",
    ];
    let output = inm(folder, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn every_json_has_the_fields_that_it_had() {
    assert_all_of(
        |command| command.writes_json,
        &CASES.map(|(command, ..)| command),
    );
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path());
    for (command, options, status) in CASES {
        let arguments: Vec<&str> = command.split(' ').chain(options.iter().copied()).collect();
        let arguments = [&arguments[..], &["--json", "-"]].concat();
        let output = inm(folder.path(), &arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {said}");
        let shape = told(&values(command, &output.stdout));
        insta::assert_snapshot!(format!("json-{}", command.replace(' ', "-")), shape);
    }
}

/// What is JSON without `--json`: models.
#[test]
fn every_model_has_the_fields_that_it_had() {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path());
    for (name, arguments) in [
        (
            "model",
            "diagnose record.npy --rate 2000 --unit g --save-model out.json",
        ),
        (
            "state-space",
            "export published --to state-space -o out.json",
        ),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let output = inm(folder.path(), &arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let json = std::fs::read(folder.path().join("out.json")).expect("written");
        let shape = told(&[serde_json::from_slice(&json).expect("JSON")]);
        insta::assert_snapshot!(format!("json-{name}"), shape);
        std::fs::remove_file(folder.path().join("out.json")).expect("its own");
    }
}

#[test]
fn a_field_that_comes_goes_or_changes_its_type_changes_the_shape() {
    let shape = |json: &str| told(&[serde_json::from_str(json).expect("JSON")]);
    let known = shape(r#"{"a": [{"b": 1}, {"b": null}], "c": "x"}"#);
    assert_eq!(
        known,
        "all of it: object\na: list\na[]: object\na[].b: null or number\nc: text\n"
    );
    for other in [
        r#"{"a": [{"b": 1}], "c": "x"}"#,
        r#"{"a": [{"b": 1}, {"b": null, "d": 1}], "c": "x"}"#,
        r#"{"a": [{"b": 1}, {"b": null}]}"#,
        r#"{"a": [{"b": 1}, {"b": null}], "c": true}"#,
    ] {
        assert_ne!(shape(other), known, "{other}");
    }
    assert_eq!(
        shape(r#"{"a": [{"b": 2e9}, {"b": null}], "c": "y"}"#),
        known
    );
}
