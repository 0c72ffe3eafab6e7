//! `inm diagnose` as a process: its files, and that its model makes data with the same effects.

use std::path::Path;

use assert_cmd::Command;
use inm_host::internals::model::Seed;
use inm_host::internals::model::random::Gaussian;
use serde_json::Value;

/// A walk for the low end, white noise, and two effects of different kinds.
const MODEL: &str = r#"{ "schema": 1, "rate_hz": 1000.0, "axes": [ { "name": "X", "mean": 9.8,
    "coefficients": { "K": 3e-4, "N": 1e-3 },
    "effects": [
      { "effect": "hum", "parameters": { "f_hz": 50.01, "amplitude_1": 2e-3, "amplitude_2": 0,
                                         "amplitude_3": 1.5e-3 } },
      { "effect": "markov", "parameters": { "amplitude": 4e-3, "time_s": 0.05 } } ] } ] }"#;

/// Seconds of 1000 samples.
const DURATION_S: &str = "262.144";

/// Standard deviations that two estimates of a parameter may differ by: one in 10 000 does.
const SIGMAS: f64 = 4.0;

/// Width of a 95 % interval in standard deviations.
const INTERVAL: f64 = 3.92;

fn inm(folder: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("inm"));
    command.current_dir(folder);
    command
}

fn simulate(folder: &Path, model: &str, seed: &str, record: &str) {
    inm(folder)
        .args(["simulate", "--model", model, "--seed", seed])
        .args(["--duration", DURATION_S, "-o", record])
        .assert()
        .success();
}

/// Diagnoses `NAME.npy` into `NAME.json` and the other files; the JSON.
fn diagnose(folder: &Path, name: &str) -> Value {
    inm(folder)
        .args(["diagnose", &format!("{name}.npy"), "--rate", "1000"])
        .args(["--unit", "m/s^2"])
        .args(["--json", &format!("{name}.json")])
        .args(["--model", &format!("{name}.model.json")])
        .args(["--report", &format!("{name}.html")])
        .args(["--png", &format!("{name}.png")])
        .assert()
        .success();
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).expect("written");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn every_decision_of_the_search_can_be_followed() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::write(folder.join("model.json"), MODEL).expect("written");
    simulate(folder, "model.json", "5", "record.npy");
    let diagnose = |more: &[&str]| {
        let mut command = inm(folder);
        command.args([
            "diagnose",
            "record.npy",
            "--rate",
            "1000",
            "--unit",
            "m/s^2",
        ]);
        let output = command.args(more).assert().success().get_output().clone();
        let text = |bytes| String::from_utf8(bytes).expect("text");
        (text(output.stdout), text(output.stderr))
    };
    let (found, said) = diagnose(&["--trace"]);
    for (kind, first) in [("hum", "f_hz"), ("markov", "time_s")] {
        assert!(found.contains(kind), "{found}");
        let taken = format!("axis 0: taken in: {kind}, {first} ");
        assert!(said.contains(&taken), "{said}");
    }
    assert_eq!(diagnose(&[]), (found, String::new()));
}

/// Findings of the axis, by name.
fn findings(diagnosis: &Value) -> Vec<(&str, &Value)> {
    let mut findings = Vec::new();
    for one in diagnosis["axes"][0]["findings"].as_array().expect("a list") {
        findings.push((one["effect"].as_str().expect("a name"), one));
    }
    findings.sort_by_key(|(name, _)| *name);
    findings
}

#[test]
fn data_of_the_model_found_show_the_same_effects_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::write(folder.join("truth.json"), MODEL).expect("written");
    simulate(folder, "truth.json", "5", "first.npy");
    let first = diagnose(folder, "first");
    let names = |all: &Value| -> Vec<String> {
        findings(all)
            .iter()
            .map(|(name, _)| (*name).to_owned())
            .collect()
    };
    assert_eq!(names(&first), ["hum", "markov"]);

    simulate(folder, "first.model.json", "6", "again.npy");
    let again = diagnose(folder, "again");
    assert_eq!(names(&again), ["hum", "markov"]);
    assert_eq!(again["axes"][0]["unexplained"], Value::Array(Vec::new()));

    for ((name, one), (_, other)) in findings(&first).into_iter().zip(findings(&again)) {
        let parameters = one["parameters"].as_object().expect("named numbers");
        for (parameter, value) in parameters {
            let other = &other["parameters"][parameter];
            let number = |of: &Value, field: &str| of[field].as_f64().expect("a number");
            let width = |of: &Value| number(of, "hi") - number(of, "lo");
            // The first estimate is the second one's truth.
            let off = (number(other, "value") - number(value, "value")) / (width(other) / INTERVAL);
            assert!(
                off.abs() < SIGMAS,
                "{name}, {parameter}: {value}, then {other}"
            );
        }
    }
    // The model in the JSON is the model file.
    let model = |path: &str| std::fs::read_to_string(folder.join(path)).expect("written");
    let file: Value = serde_json::from_str(&model("first.model.json")).expect("JSON");
    assert_eq!(file["axes"][0], first["axes"][0]["final"]["model"]);
    views(&first);
    pictures(folder);
}

/// Where the measured deviation is well known, the extended model agrees with it, a simulation of
/// it too, and the five terms alone do not.
fn views(diagnosis: &Value) {
    let views = &diagnosis["axes"][0]["views"];
    let points = views["allan"].as_array().expect("a list");
    let number = |one: &Value, field: &str| one[field].as_f64().expect("a number");
    let ratio = |one: &Value, upper: &str, lower: &str| number(one, upper) / number(one, lower);
    let sure: Vec<&Value> = points
        .iter()
        .filter(|one| ratio(one, "hi", "lo") < 1.5)
        .collect();
    assert!(sure.len() > 20, "{} points are well known", sure.len());
    // Standard deviations by which one of these is off at most.
    let off = |which: &str| {
        let one = |one: &&Value| {
            (ratio(one, which, "adev").ln() / ratio(one, "hi", "lo").ln() * INTERVAL).abs()
        };
        sure.iter().map(one).fold(0.0, f64::max)
    };
    let (before, after, simulated) = (off("before"), off("after"), off("simulated"));
    assert!(before > 10.0, "before: at most {before:.1} sigma off");
    assert!(after < 5.0, "after: {after:.1} sigma off");
    // The simulation has chance of its own.
    assert!(simulated < 7.0, "simulated: {simulated:.1} sigma off");
    assert_eq!(views["simulation_seed"], 1);
    held_out(&diagnosis["axes"][0]);
    let growth = views["velocity_error"].as_array().expect("a list");
    assert!(!growth.is_empty());
    for one in growth {
        let number = |field: &str| one[field].as_f64().expect("a number");
        assert!(number("lo") <= number("observed") && number("observed") <= number("hi"));
        assert!(number("before") > 0.0 && number("after") > 0.0);
    }
}

/// The points of the held-out half are those that the errors are of.
fn held_out(axis: &Value) {
    let points = axis["views"]["held_out"].as_array().expect("a list");
    let number = |one: &Value, field: &str| one[field].as_f64().expect("a number");
    assert!(points.len() > 20, "{} points", points.len());
    assert!(points.iter().all(|one| number(one, "edf") >= 1000.0));
    for (which, model) in [("before", "base"), ("after", "final")] {
        let squares = points
            .iter()
            .map(|one| (number(one, which) / number(one, "adev") - 1.0).powi(2));
        let rms = 100.0 * (squares.sum::<f64>() / points.len() as f64).sqrt();
        let said = number(&axis[model], "allan_error_percent");
        assert!(
            (rms / said - 1.0).abs() < 1e-9,
            "{which}: {rms}, said {said}"
        );
    }
}

/// The page holds all four pictures, the cards and the model; the bitmap is one.
fn pictures(folder: &Path) {
    let page = std::fs::read_to_string(folder.join("first.html")).expect("written");
    assert_eq!(page.matches("<svg").count(), 4);
    assert_eq!(page.matches("<article class=\"card\"").count(), 2);
    for needed in [
        "hum 50.01 Hz",
        "markov, corner",
        "On the bench",
        "without it",
        "model.json",
    ] {
        assert!(page.contains(needed), "no `{needed}` in the page");
    }
    assert!(
        !page.contains("NaN"),
        "a number that is none reached the page"
    );
    let bitmap = std::fs::read(folder.join("first.png")).expect("written");
    assert!(bitmap.starts_with(b"\x89PNG"));
}

#[test]
fn what_follows_the_temperature_is_told_for_a_degree() {
    /// Signal a degree, and degrees a count of the column.
    const GAIN: f64 = 2e-3;
    const SCALE: f64 = 0.01;
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let mut noise = Gaussian::new(Seed { seed: 3, stream: 0 }, 1e-3);
    let rows = (0..1 << 15).map(|n| {
        let degrees = 25.0 + 2.0 * (f64::from(n) * 5e-4).sin();
        let level = GAIN * (degrees - 25.0) + noise.draw();
        format!("{level:.7},{:.0}\n", degrees / SCALE)
    });
    let text = format!("level,thermistor (V)\n{}", rows.collect::<String>());
    std::fs::write(folder.join("log.csv"), text).expect("written");
    inm(folder)
        .args(["diagnose", "log.csv", "--rate", "100", "--columns", "0"])
        .args(["--unit", "m/s^2"])
        .args(["--temperature", "1", "--temperature-scale", "0.01"])
        .args(["--json", "log.json"])
        .assert()
        .success();
    let text = std::fs::read_to_string(folder.join("log.json")).expect("written");
    let told: Value = serde_json::from_str(&text).expect("JSON");
    let findings = findings(&told);
    assert_eq!(findings.len(), 1, "seed 3: {findings:?}");
    let gain = &findings[0].1["parameters"]["gain"];
    let number = |name: &str| gain[name].as_f64().expect("a number");
    let deviation = (number("hi") - number("lo")) / INTERVAL;
    assert!(
        (number("value") - GAIN).abs() < SIGMAS * deviation,
        "seed 3: {gain}"
    );
    // A tenth of the gain: the scale of a hundred would not pass for it.
    assert!(deviation < 0.1 * GAIN, "seed 3: {gain}");
}
