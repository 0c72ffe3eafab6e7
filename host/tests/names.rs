//! Names from elsewhere (axes, files) that would act on a terminal, or become a line of their own in a
//! file that a program reads.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::json;

/// Control characters, what ends a line in YAML, what turns the direction of writing, and none.
const NAMES: [&str; 6] = [
    "X\nimport os",
    "X\r\nrostopic: /imu1",
    "X\u{1b}[2J",
    "X\u{2028}rostopic: /imu1",
    "X\u{202e}",
    "",
];

fn inm(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inm"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("inm runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn model(name: &str) -> String {
    json!({ "schema": 1, "rate_hz": 100.0, "axes": [
        { "name": name, "unit": "m/s^2", "coefficients": { "N": 1e-4, "K": 1e-5, "B": 1e-5 } }
    ] })
    .to_string()
}

/// An analysis, as far as an export reads it.
fn analysis(name: &str) -> String {
    let fit = json!({ "N": { "value": 1e-4, "lo": 9e-5 }, "K": { "value": 1e-5, "lo": 9e-6 } });
    json!({ "schema": 1, "source": { "rate_hz": 100.0, "duration_s": 100.0 }, "axes": [
        { "name": name, "unit": "m/s^2", "fits": { "weighted": fit } }
    ] })
    .to_string()
}

#[test]
fn an_axis_whose_name_does_not_show_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    for name in NAMES {
        fs::write(folder.join("model.json"), model(name)).expect("written");
        fs::write(folder.join("analysis.json"), analysis(name)).expect("written");
        let formats = [
            "kalibr",
            "gnss-ins-sim",
            "matlab",
            "state-space",
            "csv",
            "npy",
        ];
        let exports = formats.iter().flat_map(|to| {
            ["model.json", "analysis.json"]
                .map(|from| vec!["export", from, "--to", to, "-o", "out"])
        });
        let simulations = ["out.csv", "out.npy"].map(|out| {
            vec![
                "simulate",
                "--model",
                "model.json",
                "--duration",
                "1",
                "-o",
                out,
            ]
        });
        for arguments in exports.chain(simulations) {
            let output = inm(folder, &arguments);
            let said = text(&output.stderr);
            assert_eq!(
                output.status.code(),
                Some(2),
                "{name:?} {arguments:?}: {said}"
            );
            assert!(said.contains(".json: axis 0 is called"), "{said}");
            assert!(said.contains("without control characters"), "{said}");
            assert_eq!(said.trim_end().lines().count(), 1, "{said:?}");
            assert!(
                !said.contains('\u{1b}') && !said.contains('\u{202e}'),
                "{said:?}"
            );
        }
    }
    assert_eq!(fs::read_dir(folder).expect("a folder").count(), 2);
}

#[test]
fn a_column_whose_name_does_not_show_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    // Lines end a name here, and one that is empty goes by its number.
    for name in NAMES
        .iter()
        .filter(|name| !name.contains('\n') && !name.is_empty())
    {
        fs::write(folder.join("log.csv"), format!("{name},y\n1,2\n2,1\n")).expect("written");
        let output = inm(
            folder,
            &["analyze", "log.csv", "--rate", "1", "--unit", "g"],
        );
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name:?}: {said}");
        assert!(said.contains("log.csv:1: a column's name"), "{said}");
    }
}

#[test]
fn a_comma_in_a_name_makes_no_column() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let name = "X, \"up\"";
    fs::write(folder.join("model.json"), model(name)).expect("written");
    let output = inm(folder, &["export", "model.json", "--to", "csv", "-o", "-"]);
    let said = text(&output.stdout);
    let rows = said.lines().skip(1).collect::<Vec<_>>().join("\n");
    let mut table = csv::Reader::from_reader(rows.as_bytes());
    assert_eq!(table.headers().expect("a header"), vec!["tau_s", name]);
    assert!(table.records().count() > 10);
}

#[cfg(unix)]
#[test]
fn a_file_name_acts_on_no_terminal_and_is_no_line_of_a_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let evil = "m\nimport os\n\u{1b}[2J.json";
    fs::write(folder.join(evil), model("X")).expect("written");
    for to in ["kalibr", "gnss-ins-sim", "matlab", "csv"] {
        let output = inm(folder, &["export", evil, "--to", to, "-o", "-"]);
        let (written, said) = (text(&output.stdout), text(&output.stderr));
        assert_eq!(output.status.code(), Some(0), "{to}: {said}");
        assert!(
            written.contains("m\\nimport os\\n\\u{1b}[2J.json"),
            "{to}: {written}"
        );
        assert!(
            !written.lines().any(|line| line.starts_with("import os")),
            "{written}"
        );
    }
    let record = "r\nimport os\u{1b}[2J.csv";
    fs::write(folder.join(record), "ax_g\n1\n2\n1\n3\n2\n1\n2\n4\n").expect("written");
    let there = inm(folder, &["analyze", record, "--rate", "100"]);
    let gone = inm(
        folder,
        &["analyze", "no\nsuch\u{1b}[2J.csv", "--rate", "100"],
    );
    assert_eq!(there.status.code(), Some(0), "{}", text(&there.stderr));
    assert_eq!(gone.status.code(), Some(2));
    for bytes in [there.stdout, there.stderr, gone.stdout, gone.stderr] {
        let said = text(&bytes);
        assert!(!said.contains('\u{1b}'), "{said:?}");
        assert!(
            !said.contains("\nimport") && !said.contains("\nsuch"),
            "{said:?}"
        );
    }
}
