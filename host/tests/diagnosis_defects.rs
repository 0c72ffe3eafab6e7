//! Records that the diagnosis once failed on, each as somebody had it.

use std::fmt::Write;
use std::path::Path;

use assert_cmd::Command;
use inm_host::internals::model::Seed;
use inm_host::internals::model::random::Gaussian;
use serde_json::Value;

const RATE_HZ: f64 = 100.0;

/// What `inm diagnose` says of these values, as JSON.
fn diagnosed(folder: &Path, values: &[f64]) -> Value {
    let text = values.iter().fold(String::new(), |mut text, value| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{value}");
        text
    });
    let record = folder.join("record.csv");
    std::fs::write(&record, text).expect("room for a record");
    let run = Command::new(assert_cmd::cargo::cargo_bin!("inm"))
        .arg("diagnose")
        .arg(&record)
        .args(["--rate", &RATE_HZ.to_string(), "--unit", "m/s^2"])
        .args(["--json", "-"])
        .assert();
    let output = run.get_output();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        matches!(output.status.code(), Some(0 | 1)),
        "{} samples: {said}",
        values.len()
    );
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn samples_that_repeat_or_clip_behind_the_last_fast_length_are_diagnosed() {
    let folder = tempfile::tempdir().expect("a folder");
    // Lengths drawn by a generator of their own; most have a large prime factor.
    let mut draw = 1_u64;
    for _ in 0..6 {
        draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let length = 8192 + (draw >> 51) as usize;
        let seed = Seed {
            seed: draw,
            stream: 0,
        };
        let mut noise = Gaussian::new(seed, 1.0);
        let mut values: Vec<f64> = (0..length).map(|_| noise.draw().min(1.5)).collect();
        // The very last samples are at the limit, and repeat.
        values[length - 3..].fill(1.5);
        let diagnosis = diagnosed(folder.path(), &values);
        let findings = diagnosis["axes"][0]["findings"].as_array().expect("a list");
        let names: Vec<&str> = findings
            .iter()
            .filter_map(|one| one["effect"].as_str())
            .collect();
        // 7 % of the samples are at the limit.
        assert!(
            names.contains(&"clipping"),
            "{length} samples, seed {draw}: {names:?}"
        );
    }
}

#[test]
fn a_shock_is_no_step_that_grows() {
    let folder = tempfile::tempdir().expect("a folder");
    for seed in 1..4 {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut swell = [0.0_f64; 2];
        // A swell about 0.3 Hz, as of the sea, and a shock of two seconds that rings at 8 Hz.
        let values: Vec<f64> = (0..40_009)
            .map(|n| {
                let next = 1.99 * swell[0] - 0.9904 * swell[1] + 0.3 * noise.draw();
                swell = [next, swell[0]];
                let since_s = (f64::from(n) - 27_123.0) / RATE_HZ;
                let shock = if (0.0..4.0).contains(&since_s) {
                    4e4 * (-since_s).exp() * (std::f64::consts::TAU * 8.0 * since_s).sin()
                } else {
                    0.0
                };
                next + 0.1 * noise.draw() + shock
            })
            .collect();
        let range = values
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs()));
        let diagnosis = diagnosed(folder.path(), &values);
        for finding in diagnosis["axes"][0]["findings"].as_array().expect("a list") {
            let parameters = finding["parameters"].as_object().expect("an object");
            for (name, value) in parameters {
                let value = value["value"].as_f64().expect("a number");
                assert!(
                    !name.starts_with("height") || value.abs() <= 2.0 * range,
                    "seed {seed}: {name} is {value} in a record within {range}"
                );
            }
        }
    }
}
