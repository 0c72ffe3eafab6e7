//! `inm record`, `live` and `replay` as a user runs them, on a virtual board.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

fn inm(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(arguments)
        .output()
        .expect("inm runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn record(path: &Path, seconds: &str) -> Output {
    let path = path.display().to_string();
    inm(&[
        "record",
        "--source",
        "virtual",
        "-o",
        &path,
        "--duration",
        seconds,
        "--seed",
        "5",
    ])
}

fn assert_refused(output: &Output, expected: &[&str]) {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    for part in expected {
        assert!(stderr.contains(part), "`{part}` is not in: {stderr}");
    }
}

#[test]
fn a_recording_is_analysed_and_replayed() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    let output = record(&capture, "3");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(
        text(&output.stdout).contains("0 lost"),
        "{}",
        text(&output.stdout)
    );

    let name = capture.display().to_string();
    let analysed = inm(&["analyze", &name, "--json", "-"]);
    assert!(analysed.status.success(), "{}", text(&analysed.stderr));
    let replayed = inm(&["replay", &name, "--json", "-"]);
    assert!(replayed.status.success(), "{}", text(&replayed.stderr));
    assert_eq!(text(&analysed.stdout), text(&replayed.stdout));
    let json: serde_json::Value = serde_json::from_slice(&analysed.stdout).expect("JSON");
    assert_eq!(json["source"]["lost_samples"], 0);
    assert_eq!(json["axes"].as_array().map(Vec::len), Some(3));
    assert!(
        json["source"]["samples"]
            .as_u64()
            .is_some_and(|samples| samples >= 6000)
    );
}

#[test]
fn a_recording_never_overwrites_one() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    std::fs::write(&capture, "precious").expect("the folder is writable");
    assert_refused(&record(&capture, "1"), &["run.inmcap", "another name"]);
    assert_eq!(std::fs::read(&capture).expect("still there"), b"precious");
}

#[test]
fn a_port_that_does_not_exist_is_named() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap").display().to_string();
    let output = inm(&["record", "--source", "/dev/ttyNONE", "-o", &capture]);
    assert_refused(
        &output,
        &["/dev/ttyNONE", "cannot be opened", "this machine"],
    );
}

/// The shell limits the size of files, which to the program is a disk that fills up.
#[cfg(unix)]
#[test]
fn a_full_disk_ends_the_recording_and_keeps_it() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    let output = Command::new("sh")
        .arg("-c")
        .arg("trap '' XFSZ; ulimit -f 200; exec \"$0\" record --source virtual -o \"$1\" --duration 60")
        .arg(env!("CARGO_BIN_EXE_inm"))
        .arg(&capture)
        .output()
        .expect("sh runs");
    assert_refused(&output, &["run.inmcap", "writing the capture"]);
    let name = capture.display().to_string();
    let analysed = inm(&["analyze", &name, "--json", "-"]);
    assert!(analysed.status.success(), "{}", text(&analysed.stderr));
    let json: serde_json::Value = serde_json::from_slice(&analysed.stdout).expect("JSON");
    // `ulimit -f` counts blocks of 512 or 1024 bytes; a conversion takes some 13.
    assert!(
        json["source"]["samples"]
            .as_u64()
            .is_some_and(|samples| samples > 6000),
        "{json}"
    );
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_recording_in_good_order() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    let mut child = Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(["record", "--source", "virtual", "--speed", "20", "-o"])
        .arg(&capture)
        .spawn()
        .expect("inm runs");
    let deadline = std::time::Instant::now() + std::time::Duration::from_secs(20);
    while std::fs::metadata(&capture).map_or(0, |data| data.len()) < 50_000 {
        assert!(std::time::Instant::now() < deadline, "nothing is recorded");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(killed.expect("kill runs").success());
    assert!(child.wait().expect("inm ends").success());
    let replayed = inm(&["replay", &capture.display().to_string()]);
    assert!(replayed.status.success());
    assert!(
        !text(&replayed.stdout).contains("was cut"),
        "{}",
        text(&replayed.stdout)
    );
}

#[test]
fn a_capture_cut_at_any_byte_gives_what_is_whole() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    // The board confirms what it said once a second; what it has not confirmed at a cut does not count.
    assert!(record(&capture, "2").status.success());
    let bytes = std::fs::read(&capture).expect("the capture reads");
    let header = bytes
        .iter()
        .position(|&byte| byte == b'\n')
        .expect("first line")
        + 1;
    let header = header
        + bytes[header..]
            .iter()
            .position(|&byte| byte == b'\n')
            .expect("second line")
        + 1;

    // Inside the header there is nothing to save.
    let cut = folder.path("cut.inmcap");
    let name = cut.display().to_string();
    for at in [14, header - 2] {
        std::fs::write(&cut, &bytes[..at]).expect("writable");
        assert_refused(&inm(&["analyze", &name]), &["cut.inmcap", "header"]);
    }
    // Behind it every whole frame counts.
    std::fs::write(&cut, &bytes[..bytes.len() - 300]).expect("writable");
    let output = inm(&["analyze", &name]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout) + &text(&output.stderr);
    assert!(told.contains("middle of a frame"), "{told}");
}

#[test]
fn a_capture_of_another_protocol_version_is_refused() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    assert!(record(&capture, "0.1").status.success());
    let bytes = std::fs::read(&capture).expect("the capture reads");
    let foreign = text(&bytes[..200]).replace("\"protocol\":2", "\"protocol\":9");
    let mut edited = foreign.into_bytes();
    edited.extend_from_slice(&bytes[200..]);
    std::fs::write(&capture, edited).expect("writable");
    let output = inm(&["analyze", &capture.display().to_string()]);
    assert_refused(&output, &["version 9", "versions 1 to 2", "run.inmcap"]);
}

#[test]
fn a_number_in_the_header_that_cannot_be_is_refused_with_its_place() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    assert!(record(&capture, "0.1").status.success());
    let bytes = std::fs::read(&capture).expect("the capture reads");
    let header_ends = 15
        + bytes[15..]
            .iter()
            .position(|&byte| byte == b'\n')
            .expect("two lines");
    let header: serde_json::Value = serde_json::from_slice(&bytes[15..header_ends]).expect("JSON");
    let number = |value: f64| serde_json::json!(value);
    let impossible = [
        ("/rate_hz", number(-1.0), "`rate_hz` is -1.0"),
        ("/rate_hz", number(0.0), "`rate_hz` is 0.0"),
        ("/rate_hz", number(1e300), "`rate_hz` is 1e300"),
        (
            "/board/timer_hz",
            serde_json::json!(0),
            "`board.timer_hz` is 0",
        ),
        (
            "/board/reference_v",
            number(-5.0),
            "`board.reference_v` is -5.0",
        ),
        ("/axes/1/scale", number(0.0), "`axes[1].scale` is 0.0"),
        ("/axes/2/name", "Z\u{1b}[2J".into(), "`axes[2].name`"),
        (
            "/axes",
            serde_json::json!([]),
            "`axes` is 0, expected three axes",
        ),
    ];
    for (field, value, told) in impossible {
        let mut edited = header.clone();
        *edited.pointer_mut(field).expect("there is such a field") = value;
        let line = format!("#inm-capture 1\n{edited}");
        let file = [line.as_bytes(), &bytes[header_ends..]].concat();
        std::fs::write(&capture, file).expect("writable");
        for command in ["analyze", "replay"] {
            let output = inm(&[command, &capture.display().to_string()]);
            assert_refused(&output, &["run.inmcap", "line 2", told, "restore line 2"]);
        }
    }
}

#[test]
fn what_is_appended_to_a_recording_is_no_part_of_it() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    assert!(record(&capture, "1").status.success());
    let name = capture.display().to_string();
    let analyzed = || {
        let output = inm(&["analyze", &name, "--json", "-"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        json["source"].clone()
    };
    let before = analyzed();
    let bytes = std::fs::read(&capture).expect("the capture reads");
    std::fs::write(&capture, [&bytes[..], &bytes[..]].concat()).expect("writable");
    let after = analyzed();
    assert_eq!(before["samples"], after["samples"]);
    assert_eq!(after["gaps"], serde_json::json!([]));
    assert!(
        after["news"].to_string().contains("behind the end"),
        "{after}"
    );
}

#[test]
fn the_published_fit_takes_the_averaging_times_it_is_given() {
    let folder = Folder::new();
    let capture = folder.path("run.inmcap");
    assert!(record(&capture, "1").status.success());
    let name = capture.display().to_string();
    let published = |options: &[&str]| {
        let output = inm(&[&["analyze", &name, "--json", "-"], options].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        json["axes"][0]["fits"]["published"].clone()
    };
    let default = published(&[]);
    let short = published(&["--published-taus", "1,2,4,8,16,32"]);
    assert!(short["Q"]["squared"].is_number(), "{short}");
    assert_ne!(short, default);
    let few = inm(&["analyze", &name, "--published-taus", "1,2,4"]);
    assert_refused(&few, &["--published-taus", "five averaging times"]);
}
