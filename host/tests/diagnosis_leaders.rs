//! What an axis has from elsewhere, the temperature or other axes: data of the model that a
//! diagnosis ends with show it again.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

/// Seconds of 500 samples.
const DURATION_S: &str = "131.072";

/// Standard deviations that two estimates of a parameter may differ by: one in 10 000 does.
const SIGMAS: f64 = 4.0;

/// Width of a 95 % interval in standard deviations.
const INTERVAL: f64 = 3.92;

fn inm(folder: &Path, arguments: &str) {
    Command::new(assert_cmd::cargo::cargo_bin!("inm"))
        .current_dir(folder)
        .args(arguments.split_whitespace())
        .assert()
        .success();
}

fn json(folder: &Path, name: &str) -> Value {
    let text = std::fs::read_to_string(folder.join(name)).expect("written");
    serde_json::from_str(&text).expect("JSON")
}

/// Value and standard deviation of the parameter of the only finding of an axis, an `effect`.
fn parameter(diagnosis: &Value, axis: usize, effect: &str, name: &str) -> [f64; 2] {
    let axis = &diagnosis["axes"][axis];
    let findings = axis["findings"].as_array().expect("a list");
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!(findings[0]["effect"], effect);
    assert_eq!(axis["unexplained"], Value::Array(Vec::new()));
    let number = |field: &str| {
        let value = &findings[0]["parameters"][name][field];
        value.as_f64().expect("a number")
    };
    [number("value"), (number("hi") - number("lo")) / INTERVAL]
}

fn assert_same(what: &str, one: [f64; 2], other: [f64; 2]) {
    let off = (one[0] - other[0]) / one[1].hypot(other[1]);
    assert!(off.abs() < SIGMAS, "{what}: {one:?}, then {other:?}");
}

#[test]
fn data_at_the_same_temperature_show_the_same_drift() {
    const MODEL: &str = r#"{ "schema": 1, "rate_hz": 500, "axes": [ { "name": "X", "mean": 9.8,
        "coefficients": { "N": 1e-4 },
        "effects": [ { "effect": "thermal", "parameters": { "gain": -3e-3, "lag_s": 2 } } ] } ] }"#;
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::write(folder.join("truth.json"), MODEL).expect("written");
    let degrees = (0..1 << 16).map(|n| {
        let t_s = f64::from(n) / 500.0;
        format!("{n},{:.6}\n", 24.0 + 0.8 * (0.09 * t_s).sin() + 0.004 * t_s)
    });
    std::fs::write(folder.join("degrees.csv"), degrees.collect::<String>()).expect("written");
    let simulate = |model: &str, seed: u32, record: &str| {
        let at = "--temperature degrees.csv --temperature-column 1";
        inm(
            folder,
            &format!(
                "simulate --model {model} --seed {seed} --duration {DURATION_S} {at} -o {record}"
            ),
        );
    };
    let gain = |name: &str| {
        inm(
            folder,
            &format!(
                "diagnose {name}.npy --rate 500 --unit m/s^2 --columns 0 --temperature 1 \
                 --json {name}.json --model {name}.model.json"
            ),
        );
        parameter(&json(folder, &format!("{name}.json")), 0, "thermal", "gain")
    };
    simulate("truth.json", 5, "first.npy");
    let first = gain("first");
    assert_same("seed 5, truth", first, [-3e-3, 0.0]);
    simulate("first.model.json", 6, "again.npy");
    assert_same("seeds 5 and 6", first, gain("again"));
}

#[test]
fn axes_that_share_noise_share_it_in_data_of_the_model() {
    const AXIS: &str = r#""coefficients": { "N": 1e-4, "K": 1e-5 }"#;
    // One source behind the gains 0.7, 0.6, -0.5 of the axes' deviations.
    let model = format!(
        r#"{{ "schema": 1, "rate_hz": 500, "axes": [ {{ "name": "X", {AXIS} }},
            {{ "name": "Y", {AXIS} }}, {{ "name": "Z", {AXIS} }} ],
            "correlation": [ [1, 0.42, -0.35], [0.42, 1, -0.3], [-0.35, -0.3, 1] ] }}"#
    );
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::write(folder.join("truth.json"), model).expect("written");
    let gains = |model: &str, seed: u32, name: &str| {
        inm(
            folder,
            &format!(
                "simulate --model {model} --seed {seed} --duration {DURATION_S} -o {name}.npy"
            ),
        );
        inm(
            folder,
            &format!(
                "diagnose {name}.npy --rate 500 --unit m/s^2 --json {name}.json --model {name}.model.json"
            ),
        );
        let told = json(folder, &format!("{name}.json"));
        [1, 2].map(|axis| parameter(&told, axis, "common_mode", "gain"))
    };
    let first = gains("truth.json", 7, "first");
    // Relative to the first axis: 0.6 / 0.7 and -0.5 / 0.7.
    for (gain, truth) in first.into_iter().zip([0.6 / 0.7, -0.5 / 0.7]) {
        assert_same("seed 7, truth", gain, [truth, 0.0]);
    }
    let found = &json(folder, "first.model.json")["correlation"];
    for (row, column, truth) in [(0, 1, 0.42), (0, 2, -0.35), (1, 2, -0.3)] {
        let found = found[row][column].as_f64().expect("a number");
        // Known to 0.004 from 65536 samples; tapered segments and bins left out cost some of them.
        assert!((found - truth).abs() < 4.0 * 0.006, "seed 7: {found}");
    }
    let again = gains("first.model.json", 8, "again");
    for (first, again) in first.into_iter().zip(again) {
        assert_same("seeds 7 and 8", first, again);
    }
}
