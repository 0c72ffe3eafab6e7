//! `inm board log` over the serial line.

use std::time::Duration;

use inm_emulator::Fault;
use inm_host::internals::link::{Connect, SerialConnect};
use inm_host::internals::virtual_board::{Misfortune, VirtualConnect};
use inm_protocol::{Command, MAX_FRAME, Request, Restart, ToBoard, encode};
use serde_json::Value;

use super::pty::PtyBoard;
use super::{inm, steady, text};

/// Has the board stream to nobody.
fn start_streaming(board: &PtyBoard) {
    let start = Command {
        id: 77,
        request: Request::Start,
    };
    let mut frame = [0; MAX_FRAME];
    let len = encode(&ToBoard::Command(start), &mut frame).expect("it has room");
    let mut port = SerialConnect::new(board.port.as_str(), 921_600)
        .open()
        .expect("it opens");
    port.write_all(&frame[..len]).expect("written");
    port.flush().expect("sent");
}

/// Y loses its DRDY 6000 words into a stream, and the watchdog bites 12 000 words into it.
#[test]
fn troubles_are_told_in_words_as_they_come() {
    let board = PtyBoard::start(VirtualConnect {
        faults: vec![(1, 6000, Fault::DrdyStops)],
        restarts: vec![Misfortune {
            words: 12_000,
            cause: Restart::Watchdog,
            dark: Duration::from_millis(100),
        }],
        ..VirtualConnect::published(1, 1.0)
    });
    start_streaming(&board);
    let folder = tempfile::tempdir().expect("a folder");
    let json = folder.path().join("log.json");
    let output = inm(&[
        "board",
        "log",
        "--port",
        &board.port,
        "--duration",
        "11",
        "--json",
        json.to_str().expect("a name"),
    ]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let mut at = 0;
    for part in [
        "it started: power came on",
        "DRDY stopped; the converter is being reset",
        "running again after",
        "the board restarted: its main loop hung and the watchdog bit",
    ] {
        let found = told[at..].find(part);
        at += found.unwrap_or_else(|| panic!("`{part}` does not follow in: {told}"));
    }
    let lines = std::fs::read_to_string(&json).expect("written");
    let entries: Vec<Value> = lines
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(entries.len(), told.lines().count(), "{told}");
    let mut stalls = entries.iter().filter(|entry| {
        entry["what"]
            .as_str()
            .is_some_and(|what| what.contains("DRDY"))
    });
    let stall = stalls.next().expect("told");
    assert_eq!(stall["axis"], "Y");
    // Noticed within a few periods of the word behind which nothing came.
    let conversion = stall["conversion"].as_u64().expect("a number");
    assert!((5900..6100).contains(&conversion), "{stall}");
    assert_eq!(stalls.next(), None, "told once");
    for entry in &entries {
        let keys: Vec<&String> = entry.as_object().expect("an object").keys().collect();
        assert_eq!(keys, ["at", "axis", "conversion", "up_s", "what"]);
    }
}

#[test]
fn a_sound_board_has_nothing_to_tell_but_who_it_is() {
    let output = inm(&["board", "log", "--port", "virtual", "--duration", "20"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert_eq!(told.lines().count(), 1, "{told}");
    assert!(
        told.contains("virtual: board 000000000000000000000000"),
        "{told}"
    );
    let json = inm(&[
        "board",
        "log",
        "--port",
        "virtual",
        "--duration",
        "5",
        "--json",
        "-",
    ]);
    let json = text(&json.stdout);
    steady().bind(|| insta::assert_snapshot!("log_as_json", json));
}

#[test]
fn a_board_that_falls_silent_is_told_once() {
    let board = PtyBoard::start(VirtualConnect::published(1, 1.0));
    let parted = std::sync::Arc::clone(&board.parted);
    let away = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_secs(3));
        parted.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    let output = inm(&["board", "log", "--port", &board.port, "--duration", "12"]);
    away.join().expect("it slept");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert_eq!(told.matches("nothing intact for 3 s").count(), 1, "{told}");
}
