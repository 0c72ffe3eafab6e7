//! A recording that survives the night, as a user runs it: a board on a serial port to which
//! things happen.

#![cfg(unix)]

mod pty;

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use inm_host::internals::virtual_board::{Misfortune, VirtualConnect};
use inm_protocol::Restart;
use pty::PtyBoard;
use serialport::{SerialPort, TTYPort};

fn inm(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(arguments)
        .output()
        .expect("inm runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A board in real time that restarts after a second of samples.
fn restarting(cause: Restart, dark: Duration) -> PtyBoard {
    let mut board = VirtualConnect::published(5, 1.0);
    board.restarts = vec![Misfortune {
        words: 2000,
        cause,
        dark,
    }];
    PtyBoard::start(board)
}

fn record(board: &PtyBoard, capture: &Path, options: &[&str]) -> Output {
    let capture = capture.display().to_string();
    let arguments = ["record", "--source", &board.port, "-o", &capture];
    inm(&[&arguments[..], options].concat())
}

/// The gaps of a capture, as `analyze` tells them.
fn gaps(capture: &Path) -> Vec<serde_json::Value> {
    let output = inm(&["analyze", &capture.display().to_string(), "--json", "-"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    json["source"]["gaps"].as_array().expect("a list").clone()
}

#[test]
fn a_board_that_restarts_behind_an_open_port_is_started_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let panicked = Restart::Panic {
        line: 112,
        file: b"src/acquire/mod.rs".iter().copied().collect(),
    };
    let board = restarting(panicked, Duration::ZERO);
    let output = record(&board, &capture, &["--duration", "3"]);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(1), "{stdout}{stderr}");
    let told = "the board stopped streaming and had restarted (its firmware panicked at \
                src/acquire/mod.rs, line 112), for ";
    assert!(stdout.contains(told), "{stdout}");
    assert!(
        stdout.contains("how many are missing is not known"),
        "{stdout}"
    );
    let gaps = gaps(&capture);
    assert_eq!(gaps.len(), 1, "{gaps:?}");
    assert!(gaps[0]["samples"].is_null(), "{gaps:?}");
    let cause = gaps[0]["cause"].as_str().expect("a cause");
    assert!(cause.starts_with(told), "{cause}");
    assert!(
        stdout.contains(cause),
        "live and replay say the same: {stdout} {cause}"
    );
}

#[test]
fn a_board_that_falls_silent_behind_an_open_port_is_waited_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let board = restarting(Restart::Watchdog, Duration::from_secs(10));
    let output = record(&board, &capture, &["--duration", "2"]);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(1), "{stdout}{stderr}");
    let told = "the board fell silent and had restarted (its main loop hung and the watchdog bit)";
    assert!(stdout.contains(told), "{stdout}");
    assert_eq!(gaps(&capture).len(), 1);
}

#[test]
fn a_board_that_stays_silent_ends_the_recording_and_keeps_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let board = restarting(Restart::Watchdog, Duration::from_secs(60));
    let options = ["--duration", "2", "--reconnect", "1"];
    let output = record(&board, &capture, &options);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("the board fell silent"), "{stderr}");
    assert!(stderr.contains("--reconnect"), "the remedy: {stderr}");
    let output = inm(&["replay", &capture.display().to_string()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let stdout = text(&output.stdout);
    assert!(
        stdout.contains("the recording ends without the stream"),
        "{stdout}"
    );
}

/// A terminal that is stopped (Ctrl-S, or a window that hangs): no byte more goes in. The first half
/// has to stay open, the second is what a program reads from and writes to.
fn stopped_terminal() -> (TTYPort, File) {
    let (near, mut far) = TTYPort::pair().expect("a pseudo terminal");
    far.set_timeout(Duration::from_millis(50)).expect("set");
    while far.write(&[b'.'; 1024]).is_ok() {}
    while far.write(b".").is_ok() {}
    let path = far.name().expect("it has a path");
    let terminal = OpenOptions::new().read(true).write(true).open(path);
    (near, terminal.expect("opens"))
}

/// Records three seconds at 4000/s with a terminal that is stopped from the beginning.
fn record_without_terminal(command: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let board = PtyBoard::start(VirtualConnect::published(5, 1.0));
    let (_near, terminal) = stopped_terminal();
    let mut child = Command::new(env!("CARGO_BIN_EXE_inm"))
        .args([command, "--source", &board.port, "--rate", "4000"])
        .args(["--duration", "3", "-o"])
        .arg(&capture)
        .stdin(terminal.try_clone().expect("a copy"))
        .stderr(terminal)
        .stdout(Stdio::null())
        .spawn()
        .expect("inm runs");
    let deadline = Instant::now() + Duration::from_secs(60);
    let status = loop {
        if let Some(status) = child.try_wait().expect("it is our child") {
            break status;
        }
        if Instant::now() > deadline {
            child.kill().expect("killed");
            panic!("the recording waits for its terminal");
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    assert_eq!(status.code(), Some(0));
    assert_eq!(gaps(&capture), Vec::<serde_json::Value>::new());
}

#[test]
fn a_stopped_terminal_costs_record_no_sample() {
    record_without_terminal("record");
}

#[test]
fn a_stopped_terminal_costs_live_no_sample() {
    record_without_terminal("live");
}
