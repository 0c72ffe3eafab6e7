//! Who is there, and restarted.

use inm_host::internals::virtual_board::VirtualConnect;
use inm_protocol::Restart;
use serde_json::Value;

use super::pty::PtyBoard;
use super::{inm, json, steady, text};

/// A board in real time, with this serial number.
fn board(serial: [u32; 3]) -> PtyBoard {
    PtyBoard::start(VirtualConnect {
        serial,
        ..VirtualConnect::published(1, 1.0)
    })
}

#[test]
fn info_tells_what_a_board_behind_a_port_is() {
    let board = board([1, 2, 0xABC]);
    let output = inm(&["board", "info", "--port", &board.port]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    let json = json(&["board", "info", "--port", &board.port], 0);
    assert_eq!(json["serial"], "000000010000000200000abc");
    steady().bind(|| {
        insta::assert_snapshot!("info_as_text", told);
        insta::assert_snapshot!(
            "info_as_json",
            serde_json::to_string_pretty(&json).expect("JSON")
        );
    });
}

#[test]
fn info_and_log_tell_of_a_pulse_a_second() {
    let board = PtyBoard::start(VirtualConnect::published(1, 1.0).with_pulses(1));
    let info = json(&["board", "info", "--port", &board.port], 0);
    assert!(info["pulse"]["number"].as_u64() >= Some(1), "{info}");
    assert_eq!(info["pulse"]["counters"]["early"], 0, "{info}");
    let arguments = ["board", "info", "--port", &board.port];
    let told = text(&inm(&arguments).stdout);
    assert!(told.contains("pulse       one a second: "), "{told}");
    let arguments = ["board", "log", "--port", &board.port, "--duration", "2"];
    let told = text(&inm(&arguments).stdout);
    assert!(told.contains("a pulse a second comes"), "{told}");
}

#[test]
fn a_board_is_chosen_by_a_part_of_its_serial_number() {
    let boards = [board([1, 0, 0xAAAA]), board([2, 0, 0xBBBB])];
    let ports = ["--port", &boards[0].port, "--port", &boards[1].port];
    for (wanted, serial, port) in [
        ("AAAA", "00000001000000000000aaaa", &boards[0].port),
        ("bbbb", "00000002000000000000bbbb", &boards[1].port),
    ] {
        let arguments = [&["board", "info", "--serial", wanted], &ports[..]].concat();
        let info = json(&arguments, 0);
        assert_eq!(info["serial"], serial);
        assert_eq!(info["port"], port.as_str());
    }
    for (wanted, expected) in [
        ("0000", "several boards are meant"),
        (
            "cccc",
            "no board whose serial number contains `cccc` answers",
        ),
    ] {
        let arguments = [&["board", "info", "--serial", wanted], &ports[..]].concat();
        let said = super::fail(&arguments);
        assert!(said.contains(expected), "{said}");
        for serial in ["00000001000000000000aaaa", "00000002000000000000bbbb"] {
            assert!(said.contains(serial), "{said}");
        }
    }
}

#[test]
fn ports_asks_only_those_that_are_named() {
    let board = board([7, 7, 7]);
    let answer = |ports: &Value| {
        let listed = ports.as_array().expect("a list").iter();
        let mut here = listed.filter(|port| port["name"] == board.port.as_str());
        here.next().map(|port| port["answer"].clone())
    };
    let all = json(&["board", "ports"], 0);
    let all = all.as_array().expect("a list");
    assert!(all.iter().all(|port| port["answer"].is_null()), "{all:?}");
    let named = json(&["board", "ports", &board.port], 0);
    let answer = answer(&named).expect("a port that was named is in the list");
    assert_eq!(answer["board"]["serial"], "000000070000000700000007");
    let others = named.as_array().expect("a list").iter();
    for other in others.filter(|port| port["name"] != board.port.as_str()) {
        assert!(other["answer"].is_null(), "{other}");
    }
    let mut listed = named.as_array().expect("a list").iter();
    let here = listed.find(|port| port["name"] == board.port.as_str());
    steady().bind(|| {
        insta::assert_snapshot!(
            "ports_as_json",
            serde_json::to_string_pretty(&here).expect("JSON")
        );
    });
    let told = text(&inm(&["board", "ports", &board.port]).stdout);
    assert!(
        told.contains("    board 000000070000000700000007, firmware"),
        "{told}"
    );
}

#[test]
fn a_port_without_a_board_is_told_from_one_that_cannot_be_opened() {
    let silent = board([1, 1, 1]);
    silent
        .parted
        .store(true, std::sync::atomic::Ordering::Relaxed);
    let ports = json(&["board", "ports", &silent.port, "/dev/ttyNOPE"], 0);
    let nobody = |name: &str| {
        let mut ports = ports.as_array().expect("a list").iter();
        let port = ports.find(|port| port["name"] == name).expect("named");
        port["answer"]["nobody"].as_str().expect("words").to_owned()
    };
    assert_eq!(nobody(&silent.port), "no answer");
    assert!(nobody("/dev/ttyNOPE").contains("cannot be opened"));
}

#[test]
fn a_reset_is_over_when_the_board_is_back_and_says_that_it_was_told() {
    let board = board([1, 2, 3]);
    let output = inm(&["board", "reset", "--port", &board.port]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    steady().bind(|| insta::assert_snapshot!("reset_as_text", told));
    // Restarted on command before, it is not taken for restarted now but for its young clock.
    let json = json(&["board", "reset", "--port", &board.port], 0);
    assert_eq!(json["restart"], serde_json::json!(Restart::Command));
    assert_eq!(json["as_told"], true);
    let back_s = json["back_after_s"].as_f64().expect("a time");
    // It restarts 200 ms after its reply, and looks for nothing but its converters.
    assert!((0.1..10.0).contains(&back_s), "{back_s} s");
    steady().bind(|| {
        insta::assert_snapshot!(
            "reset_as_json",
            serde_json::to_string_pretty(&json).expect("JSON")
        );
    });
    let info = super::json(&["board", "info", "--port", &board.port], 0);
    assert_eq!(info["restart"], serde_json::json!(Restart::Command));
}
