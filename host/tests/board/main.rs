//! `inm board` as a user runs it: against virtual boards behind pseudo terminals, which to the program are
//! serial ports, and against `virtual`.

#[cfg(feature = "image")]
#[path = "../image/mod.rs"]
mod image;
#[path = "../pty/mod.rs"]
mod pty;

mod asked;
mod checked;
mod logged;
#[cfg(feature = "image")]
mod updated;

use std::process::{Command, Output};

use insta::Settings;
use serde_json::Value;

fn inm(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(arguments)
        .output()
        .expect("inm runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a command that must end with `status`, and returns the JSON that it writes.
#[track_caller]
fn json(arguments: &[&str], status: i32) -> Value {
    let arguments = [arguments, &["--json", "-"]].concat();
    let output = inm(&arguments);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {said}");
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Runs a command that must end with exit status 2, and returns its message.
#[track_caller]
fn fail(arguments: &[&str]) -> String {
    let output = inm(arguments);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    said
}

/// Snapshots without what differs from run to run: releases, ports, times.
fn steady() -> Settings {
    let mut settings = Settings::clone_current();
    for (pattern, stands_for) in [
        (r"/dev/(pts/\d+|ttys\d+)", "[port]"),
        (
            r#""firmware": "\d+\.\d+\.\d+""#,
            r#""firmware": "[release]""#,
        ),
        (r#""before": "\d+\.\d+\.\d+""#, r#""before": "[release]""#),
        (r#""program": "\d+\.\d+\.\d+""#, r#""program": "[release]""#),
        (r"\b\d+\.\d+\.\d+ for", "[release] for"),
        (r"firmware \d+\.\d+\.\d+", "firmware [release]"),
        (r"program is \d+\.\d+\.\d+", "program is [release]"),
        (r"up for \d+\.\d s", "up for [time] s"),
        (r#""up_s": \d+\.\d+"#, r#""up_s": "[time]""#),
        // The board counts what it has sent until it is asked, which is sooner or later.
        (r#""frames_sent": \d+"#, r#""frames_sent": "[count]""#),
        (r#""group": ("[^"]*"|null)"#, r#""group": "[group]""#),
        (r#""at":"[^"]*""#, r#""at":"[time]""#),
        (r"after \d+\.\d s", "after [time] s"),
        (r#""back_after_s": \d+\.\d+"#, r#""back_after_s": "[time]""#),
        (
            r"ports of this machine: .*",
            "ports of this machine: [ports]",
        ),
        (
            r"this machine has no serial port.*",
            "ports of this machine: [ports]",
        ),
    ] {
        settings.add_filter(pattern, stands_for);
    }
    settings
}

#[test]
fn every_refusal_names_the_place_and_the_remedy() {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = std::fs::read("../tests/golden/board.inmcap").expect("a recording");
    let recording = folder.path().join("run.inmcap");
    std::fs::write(&recording, &capture).expect("written");
    let recording = recording.to_str().expect("a name");
    let mut transcript = String::new();
    for (shown, arguments) in [
        ("board info", &["board", "info"][..]),
        (
            "board info --serial 1234",
            &["board", "info", "--serial", "1234"],
        ),
        (
            "board info --port /dev/ttyNOPE",
            &["board", "info", "--port", "/dev/ttyNOPE"],
        ),
        (
            "board info --port virtual --serial ffff",
            &["board", "info", "--port", "virtual", "--serial", "ffff"],
        ),
        (
            "board info --port virtual --port virtual",
            &["board", "info", "--port", "virtual", "--port", "virtual"],
        ),
        (
            "board selftest --port virtual --watch 0",
            &["board", "selftest", "--port", "virtual", "--watch", "0"],
        ),
        (
            "board info --port virtual --json run.inmcap",
            &["board", "info", "--port", "virtual", "--json", recording],
        ),
        (
            "board log --port virtual --json run.inmcap",
            &["board", "log", "--port", "virtual", "--json", recording],
        ),
        ("board reset --port", &["board", "reset", "--port"]),
    ] {
        let message = fail(arguments).replace(recording, "run.inmcap");
        transcript += &format!("$ inm {shown}\n{message}\n");
    }
    assert_eq!(std::fs::read(recording).expect("there"), capture);
    steady().bind(|| insta::assert_snapshot!(transcript));
}
