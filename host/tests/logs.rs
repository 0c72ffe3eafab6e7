//! Logs as people have them: each gives the right rate, unit, noise and gaps, or is refused with a
//! remedy that works.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

#[path = "logs/log.rs"]
mod log;
#[path = "logs/text.rs"]
mod text;
#[path = "logs/time.rs"]
mod time;
#[path = "logs/unit.rs"]
mod unit;

use log::{DEVIATION, Log};

/// Standard errors that the noise may be off by.
const SIGMAS: f64 = 5.0;

fn analyze(folder: &Path, log: &Log, say: &str) -> (Option<i32>, Value, String) {
    let output = Command::new(assert_cmd::cargo::cargo_bin!("inm"))
        .current_dir(folder)
        .args(["analyze", "log.csv", "--json", "-"])
        .args(say.split_whitespace())
        .output()
        .expect("inm runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let json = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    println!("{}: inm analyze {say}\n{said}", log.what);
    (output.status.code(), json, said)
}

/// Checks what came of a log against what went into it.
fn check(log: &Log, told: &Value) {
    let (what, source) = (log.what, &told["source"]);
    let rate_hz = source["rate_hz"].as_f64().expect("a rate");
    assert!(
        (rate_hz / log.rate_hz - 1.0).abs() < log.rate_within,
        "{what}: {rate_hz}/s"
    );
    assert_eq!(source["samples"], log.samples, "{what}");
    assert_eq!(source["lost_samples"], log.lost, "{what}");
    assert_eq!(
        source["gaps"].as_array().map(Vec::len),
        Some(log.gaps),
        "{what}"
    );
    let axes = told["axes"].as_array().expect("axes");
    assert_eq!(axes.len(), log.axes, "{what}");
    for axis in axes {
        assert_eq!(axis["unit"], log.unit, "{what}");
        assert_eq!(axis["invalid_samples"], log.invalid, "{what}");
        // White noise: all of it shows in the shortest differences.
        let number = |name: &str| axis["allan"][0][name].as_f64().expect("a number");
        let n = number("adev") * number("tau_s").sqrt();
        let expected = log.worth * DEVIATION / log.rate_hz.sqrt();
        // Neighbours' differences share samples: 3/4 of the freedom is left.
        let error = (0.5 / (0.75 * log.samples as f64)).sqrt();
        assert!(
            (n / expected - 1.0).abs() < SIGMAS * error,
            "{what}: N {n}, {expected}"
        );
    }
    let news = source["news"].to_string();
    assert!(news.contains(log.news), "{what}: {news}");
}

fn run(logs: Vec<Log>) {
    let folder = tempfile::tempdir().expect("a folder");
    for log in logs {
        std::fs::write(folder.path().join("log.csv"), &log.text).expect("written");
        let mut say = log.say;
        if let Some((message, remedy)) = log.refused {
            let (status, _, said) = analyze(folder.path(), &log, say);
            assert_eq!(status, Some(2), "{}: {said}", log.what);
            assert!(said.contains(message), "{}: {said}", log.what);
            say = remedy;
        }
        let (status, told, said) = analyze(folder.path(), &log, say);
        assert_eq!(status, Some(0), "{}: {said}", log.what);
        check(&log, &told);
    }
}

#[test]
fn stamps_in_any_unit_give_the_rate_or_ask_for_it() {
    run(time::units());
}

#[test]
fn jitter_and_bursts_make_no_gap_and_losses_are_found() {
    run(time::jitter());
}

#[test]
fn units_are_taken_from_the_header_or_asked_for() {
    run(unit::logs());
}

#[test]
fn text_is_read_as_programs_write_it() {
    run(text::logs());
}
