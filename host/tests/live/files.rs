//! What `inm live` keeps, and where.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Records two seconds of a virtual board in `folder`.
fn live(folder: &Path, options: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inm"))
        .current_dir(folder)
        .args(["live", "--source", "virtual", "--speed", "0", "--plain"])
        .args(["--duration", "2"])
        .args(options)
        .output()
        .expect("inm runs")
}

/// The files of a folder, in the order of their names.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("a file").path()).collect();
    files.sort();
    files
}

/// The samples an axis that a capture holds.
fn samples(capture: &Path) -> u64 {
    let analysed = Command::new(env!("CARGO_BIN_EXE_inm"))
        .arg("analyze")
        .arg(capture)
        .args(["--json", "-"])
        .output()
        .expect("inm runs");
    let json: serde_json::Value = serde_json::from_slice(&analysed.stdout).expect("JSON");
    json["source"]["samples"].as_u64().expect("a number")
}

#[test]
fn everything_is_recorded_unless_it_is_not_to_be() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut known = Vec::new();
    // The second begins in the same second, or in the next: its name is free in any case.
    for _ in 0..2 {
        let output = live(folder.path(), &[]);
        let said = String::from_utf8_lossy(&output.stderr);
        let told = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{said}");
        let new: Vec<PathBuf> = files(folder.path())
            .into_iter()
            .filter(|file| !known.contains(file))
            .collect();
        let [capture] = &new[..] else {
            panic!("one new file: {new:?}");
        };
        let name = capture.file_name().expect("a name").to_string_lossy();
        // At the beginning, and at the end.
        assert!(said.starts_with(&format!("virtual -> {name} ")), "{said}");
        assert!(told.starts_with(&format!("{name}: ")), "{told}");
        assert!(samples(capture) >= 4000, "{name}");
        known.push(capture.clone());
    }
    let before: Vec<_> = known.iter().map(std::fs::read).map(Result::ok).collect();
    let output = live(folder.path(), &["--no-record"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(files(folder.path()).len(), 2);
    let after: Vec<_> = known.iter().map(std::fs::read).map(Result::ok).collect();
    assert_eq!(before, after);
}

#[test]
fn a_file_that_is_named_is_taken_and_never_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = live(folder.path(), &["-o", "run.inmcap"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let capture = folder.path().join("run.inmcap");
    let bytes = std::fs::read(&capture).expect("the capture");
    let refused = live(folder.path(), &["-o", "run.inmcap"]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(
        said.contains("run.inmcap") && said.contains("another name"),
        "{said}"
    );
    assert_eq!(std::fs::read(&capture).expect("still there"), bytes);
    assert_eq!(files(folder.path()), [capture]);
}
