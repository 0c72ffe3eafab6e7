//! Records that hold less than they seem to: it is said, and never taken for a sound record.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn inm(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inm"))
        .current_dir(folder)
        .args(arguments.split(' '))
        .output()
        .expect("inm runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A capture of the virtual board, and the length of its header.
fn recorded(folder: &Path) -> (Vec<u8>, usize) {
    let output = inm(folder, "record --source virtual --duration 2 -o run.inmcap");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let bytes = fs::read(folder.join("run.inmcap")).expect("a capture");
    let lines = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    let header = lines.map(|(at, _)| at + 1).nth(1).expect("two lines");
    (bytes, header)
}

#[test]
fn a_capture_without_samples_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let (bytes, header) = recorded(folder);
    let noise = [&bytes[..header], &[1; 500], &[0]].concat();
    for (whole, frames) in [(&bytes[..header], "0 damaged"), (&noise, "1 damaged")] {
        fs::write(folder.join("empty.inmcap"), whole).expect("written");
        for command in [
            "analyze empty.inmcap --json out.json",
            "diagnose empty.inmcap --save-model out.json",
            "replay empty.inmcap",
        ] {
            let output = inm(folder, command);
            let said = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{command}: {said}");
            for part in [
                "empty.inmcap: the capture holds no samples",
                frames,
                "record again",
            ] {
                assert!(said.contains(part), "{command}: `{part}` is not in: {said}");
            }
            assert!(!folder.join("out.json").exists(), "{command}");
        }
    }
}

#[test]
fn a_file_of_missing_samples_alone_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    for cell in ["nan", "inf", "-inf"] {
        fs::write(
            folder.join("x.csv"),
            format!("ax_g\n{}", format!("{cell}\n").repeat(300)),
        )
        .expect("written");
        let output = inm(folder, "analyze x.csv --rate 100 --json out.json");
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains("x.csv: none of the 300 samples counts"),
            "{said}"
        );
        assert!(!folder.join("out.json").exists());
    }
}

/// Fifty samples that are no numbers were "No gaps.", and infinity was taken for missing silently.
#[test]
fn what_is_missing_of_an_axis_is_told_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let cell = |row: usize| match row {
        100..150 => "nan".to_owned(),
        200 | 202 => "-inf".to_owned(),
        201 => "inf".to_owned(),
        _ => format!("{}", (row * row) % 17),
    };
    let rows: String = (0..400)
        .map(|row| format!("{},{}\n", cell(row), row % 5))
        .collect();
    fs::write(folder.join("x.csv"), format!("ax_g,ay_g\n{rows}")).expect("written");
    let output = inm(folder, "analyze x.csv --rate 100 --report out.html");
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(!told.contains("No gaps."), "{told}");
    let words = "axis ax_g alone: 53 samples in 2 stretches do not count, the first at 1.00000 s, \
                 at most 0.500 s on end";
    // Row 200 is line 202: the header is the first, and rows count from 0.
    let infinite = "3 infinite numbers count as missing, the first in x.csv:202, column ax_g";
    for part in ["No gaps that all axes share.", words, infinite] {
        assert!(told.contains(part), "`{part}` is not in: {told}");
    }
    assert!(!told.contains("axis ay_g alone"), "{told}");
    let page = fs::read_to_string(folder.join("out.html")).expect("a page");
    assert!(page.contains(words) && page.contains(infinite));
    let output = inm(folder, "analyze x.csv --rate 100 --json -");
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let expected = serde_json::json!([{
        "axis": "ax_g", "samples": 53, "stretches": 2, "first_s": 1.0, "longest_s": 0.5
    }]);
    assert_eq!(json["source"]["unusable"], expected);
}

#[test]
fn a_capture_is_read_from_standard_input() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let (bytes, header) = recorded(folder);
    let through = |bytes: &[u8], arguments: &str| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_inm"))
            .args(arguments.split(' '))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("inm runs");
        let mut input = child.stdin.take().expect("a pipe");
        // Refused ahead of its end, the rest goes nowhere.
        let _ = input.write_all(bytes);
        drop(input);
        child.wait_with_output().expect("inm ends")
    };
    let json = |output: Output| {
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let mut json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        json["source"]["file"].take();
        json
    };
    let file = json(inm(folder, "analyze run.inmcap --json -"));
    assert_eq!(json(through(&bytes, "analyze - --json -")), file);
    for (bytes, arguments, expected) in [
        (&bytes[..], "analyze - --rate 100", "leave out --rate"),
        (
            &bytes[..header],
            "analyze -",
            "standard input: the capture holds no samples",
        ),
        (&bytes[..header - 5], "analyze -", "inside its header"),
    ] {
        let output = through(bytes, arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(expected), "`{expected}` is not in: {said}");
    }
}
