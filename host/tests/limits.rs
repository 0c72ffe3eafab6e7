//! Numbers and circumstances at which the program panicked or was killed: each is refused with a
//! remedy, or of no consequence.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

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

/// Refused with status 2 and all of `expected`, and nothing was written into the folder.
fn assert_refused(folder: &Path, arguments: &str, expected: &[&str]) {
    let before = files(folder);
    let output = inm(folder, arguments);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments}: {said}");
    for part in expected {
        assert!(
            said.contains(part),
            "{arguments}: `{part}` is not in: {said}"
        );
    }
    assert_eq!(files(folder), before, "{arguments}");
}

fn files(folder: &Path) -> Vec<std::ffi::OsString> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> = entries
        .map(|one| one.expect("an entry").file_name())
        .collect();
    names.sort();
    names
}

/// A capture of the virtual board, `seconds` long.
fn record(folder: &Path, seconds: &str) {
    let output = inm(
        folder,
        &format!("record --source virtual --duration {seconds} -o run.inmcap"),
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn a_time_that_no_clock_holds_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    record(folder, "0.1");
    let recording = "record --source virtual --duration 0.1 -o other.inmcap";
    for reconnect in ["1e30", "nan", "-1"] {
        let arguments = format!("{recording} --reconnect={reconnect}");
        assert_refused(folder, &arguments, &["--reconnect", "0 to 3.2e9"]);
    }
    for speed in ["1e-300", "nan", "inf", "-1", "1e300"] {
        for command in [recording, "replay run.inmcap"] {
            let arguments = format!("{command} --speed={speed}");
            assert_refused(folder, &arguments, &["--speed", "1e-6 to 1e6"]);
        }
    }
    for duration in ["nan", "-1", "0"] {
        let arguments = format!("demo --duration={duration}");
        assert_refused(folder, &arguments, &["--duration", "a positive number"]);
    }
}

#[test]
fn a_rate_that_no_record_has_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let model = r#"{"schema":1,"rate_hz":RATE,"axes":[{"name":"X","coefficients":{"N":1e-4}}]}"#;
    fs::write(folder.join("x.csv"), "1\n2\n3\n2\n").expect("written");
    for rate in ["1e308", "1e-300", "0", "-1"] {
        fs::write(folder.join("m.json"), model.replace("RATE", rate)).expect("written");
        for command in [
            "simulate --model m.json --duration 1 -o out.npy",
            "export m.json --to csv -o out.csv",
            "export m.json --to state-space -o out.json",
        ] {
            assert_refused(folder, command, &["m.json", "rate_hz", "1e-5 to 1e9"]);
        }
        assert_refused(
            folder,
            &format!("simulate --model published --rate {rate} --duration 1e-6 -o out.npy"),
            &["rate"],
        );
        assert_refused(
            folder,
            &format!("analyze x.csv --unit g --rate {rate}"),
            &["x.csv", "1e-5 to 1e9", "--rate"],
        );
    }
}

#[test]
fn numbers_whose_squares_overflow_are_refused_with_their_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let rows: String = (0..3000)
        .map(|row| format!("{}e{}\n", row % 7, if row == 1234 { 200 } else { 0 }))
        .collect();
    fs::write(folder.join("big.csv"), format!("ax_g\n{rows}")).expect("written");
    let analyze = "analyze big.csv --rate 100 --png big.png --report big.html";
    // Row 1234 is line 1236: the header is the first, and rows count from 0.
    assert_refused(folder, analyze, &["big.csv:1236", "2e200", "1e100", "nan"]);
    let scaled = "analyze big.csv --rate 100 --unit g --scale 1e200";
    assert_refused(folder, scaled, &["a scale of 1e200", "1e-30 to 1e30"]);
}

#[test]
fn numbers_whose_squares_come_to_nothing_are_refused_and_larger_ones_are_right() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let noise = |row: u64| (row * 7919 % 1009) as f64 / 1009.0 - 0.5;
    let write = |name: &str, scale: f64| {
        let rows: String = (0..9000)
            .map(|row| format!("{:e}\n", noise(row) * scale))
            .collect();
        fs::write(folder.join(name), format!("ax_g\n{rows}")).expect("written");
    };
    for scale in [1e-101, 1e-160, 1e-300] {
        write("small.csv", scale);
        for command in ["analyze", "diagnose"] {
            let command = format!("{command} small.csv --rate 100");
            assert_refused(folder, &command, &["small.csv", "ax", "1e-100", "unit"]);
        }
    }
    let shortest = |scale| {
        write("fair.csv", scale);
        let output = inm(folder, "analyze fair.csv --rate 100 --json -");
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let told = json["axes"][0]["allan"][0]["adev"].as_f64();
        told.expect("a number") / scale
    };
    let ratio = shortest(1e-98) / shortest(1.0);
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
}

#[test]
fn a_table_with_more_columns_than_a_sensor_has_axes_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let row = |row: usize| {
        let cells: Vec<String> = (0..1000).map(|k| ((row * k) % 11).to_string()).collect();
        cells.join(",")
    };
    let rows: Vec<String> = (0..100).map(row).collect();
    fs::write(folder.join("wide.csv"), rows.join("\n")).expect("written");
    let analyze = "analyze wide.csv --rate 100 --unit g";
    assert_refused(folder, analyze, &["wide.csv", "1000 columns", "--columns"]);
    let output = inm(folder, &format!("{analyze} --columns 3,998"));
    assert!(output.status.success(), "{}", text(&output.stderr));
}

/// A reader that goes away, as `head` does, was a panic, and a recording's status was lost.
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    for arguments in [
        "record --source virtual --duration 0.1 -o run.inmcap",
        "analyze run.inmcap",
        "replay run.inmcap",
        "simulate --model published:X --duration 100 -o -",
    ] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = Command::new(env!("CARGO_BIN_EXE_inm"))
            .current_dir(folder)
            .args(arguments.split(' '))
            .stdout(writer)
            .stderr(Stdio::piped())
            .output()
            .expect("inm runs");
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments}: {said}");
        assert!(!said.contains("panic"), "{arguments}: {said}");
    }
    // Neither is one of messages: the status says what there was to say.
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let status = Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(["analyze", "no-such-file.npy"])
        .stderr(writer)
        .status()
        .expect("inm runs");
    assert_eq!(status.code(), Some(2));
}

/// Two seconds are the longest record that is transformed as a whole: it took 1.8 GB.
#[cfg(target_os = "linux")]
#[test]
fn a_capture_of_two_seconds_is_analysed_in_little_memory() {
    /// Data of the process, kB: a tenth of what it took, several times what it takes.
    const LIMIT_KB: u32 = 200_000;
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    record(folder, "2");
    let output = Command::new("sh")
        .current_dir(folder)
        .args(["-c", &format!("ulimit -d {LIMIT_KB}; exec \"$0\" \"$@\"")])
        .arg(env!("CARGO_BIN_EXE_inm"))
        .args(["analyze", "run.inmcap"])
        .output()
        .expect("inm runs");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
}
