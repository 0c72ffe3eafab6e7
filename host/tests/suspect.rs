//! `inm diagnose --suspect`: what is told of a kind that is not found, and that nothing else depends on it.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

/// White noise and a walk.
const CLEAN: &str = r#"{ "schema": 1, "rate_hz": 100.0, "axes": [ { "name": "X",
    "coefficients": { "K": 3e-4, "N": 1e-3 } } ] }"#;

/// The same with Markov noise far above what a name needs.
const WANDERS: &str = r#"{ "schema": 1, "rate_hz": 100.0, "axes": [ { "name": "X",
    "coefficients": { "K": 3e-4, "N": 1e-3 },
    "effects": [ { "effect": "markov", "parameters": { "amplitude": 1e-2, "time_s": 0.5 } } ] } ] }"#;

/// Length of the records, seconds.
const DURATION_S: f64 = 400.0;

fn inm(folder: &Path, arguments: &str) -> (Option<i32>, String, String) {
    let output = Command::new(assert_cmd::cargo::cargo_bin!("inm"))
        .current_dir(folder)
        .args(arguments.split_whitespace())
        .output()
        .expect("inm runs");
    let [said, complained] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("text"));
    (output.status.code(), said, complained)
}

/// A record of this model, seed 3.
fn record(folder: &Path, model: &str) {
    std::fs::write(folder.join("model.json"), model).expect("written");
    let arguments =
        format!("simulate --model model.json --seed 3 --duration {DURATION_S} -o a.npy");
    let made = inm(folder, &arguments);
    assert_eq!(made.0, Some(0), "{}", made.2);
}

fn diagnosed(folder: &Path, options: &str) -> Value {
    let arguments = format!("diagnose a.npy --rate 100 --unit m/s^2 --json - {options}");
    let (status, said, complained) = inm(folder, &arguments);
    assert_eq!(status, Some(0), "{complained}");
    serde_json::from_str(&said).expect("JSON")
}

#[test]
fn a_kind_that_is_not_found_has_odds_and_limits_and_changes_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    record(folder, CLEAN);
    let plain = diagnosed(folder, "");
    assert_eq!(plain["axes"][0].get("suspects"), None);
    let mut asked = diagnosed(
        folder,
        "--suspect markov --suspect telegraph --suspect steps",
    );
    let axis = asked["axes"][0].as_object_mut().expect("an axis");
    let suspects = axis.remove("suspects").expect("what was asked for");
    assert_eq!(asked, plain);

    let [markov, telegraph, steps] = &suspects.as_array().expect("a list")[..] else {
        panic!("three were asked for: {suspects}");
    };
    for (one, name) in [(markov, "markov"), (telegraph, "telegraph")] {
        assert_eq!(one["effect"], name);
        let nats = |name: &str| one["best"][name].as_f64().expect("a number");
        assert!(nats("gain_nats") < nats("needed_nats"), "{one}");
        assert!(!one["limits"].as_array().expect("a list").is_empty());
    }
    // Two levels a deviation to either side, each kept for twice the correlation time.
    let pairs = |one: &Value, size: &str, time: &str| -> Vec<(f64, f64)> {
        let limits = one["limits"].as_array().expect("a list").iter();
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        limits
            .inspect(|one| assert_eq!(one["size"], size))
            .map(|one| (number(&one["upper"]), number(&one["at"][time])))
            .filter(|pair| pair.0.is_finite())
            .collect()
    };
    let doubled: Vec<(f64, f64)> = pairs(markov, "amplitude", "time_s")
        .iter()
        .map(|(size, time_s)| (2.0 * size, 2.0 * time_s))
        // With fewer than 400 dwells the spectrum sets no bound.
        .filter(|(_, dwell_s)| 400.0 * dwell_s <= DURATION_S)
        .collect();
    assert!(doubled.len() > 3, "{doubled:?}");
    assert_eq!(pairs(telegraph, "height", "dwell_s"), doubled);
    assert_eq!(steps["best"], Value::Null);
    assert_eq!(steps["limits"], Value::Array(Vec::new()));
}

#[test]
fn a_kind_that_is_found_is_a_finding_and_no_suspect() {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), WANDERS);
    let asked = diagnosed(folder.path(), "--suspect markov");
    assert_eq!(asked["axes"][0]["findings"][0]["effect"], "markov");
    assert_eq!(asked["axes"][0].get("suspects"), None);
}

#[test]
fn the_text_tells_what_a_name_would_have_needed_and_where_nothing_is_computed() {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), CLEAN);
    let asked = "diagnose a.npy --rate 100 --unit m/s^2 --suspect markov --suspect steps";
    let (_, said, _) = inm(folder.path(), asked);
    for part in [
        "Suspected, not found: markov",
        "nats where a name needs",
        "amplitude in m/s^2 at most, 95 %: ",
        "Suspected, not found: steps",
        "no limit is computed for this kind",
    ] {
        assert!(said.contains(part), "`{part}` is not in: {said}");
    }
}

#[test]
fn a_kind_that_there_is_not_is_refused_with_those_that_there_are() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["markow", "unnamed"] {
        let arguments = format!("diagnose a.npy --suspect {name}");
        let (status, _, complained) = inm(folder.path(), &arguments);
        assert_eq!(status, Some(2), "{complained}");
        assert!(complained.contains("telegraph"), "{complained}");
    }
}
