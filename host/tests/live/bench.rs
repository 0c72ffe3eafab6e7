//! What a tab may have done to the board: another recording, other settings, a stop, a self-test.

use std::fs;
use std::path::Path;

use inm_host::internals::virtual_board::VirtualConnect;

use crate::pty::PtyBoard;
use crate::served::{Served, source, wait_for};

/// Settings as the form of the page sends them.
fn settings(rate: &str) -> String {
    format!(r#"{{"rate":"{rate}","phase":"minimum","high_pass":""}}"#)
}

/// The header of a capture, which is its second line.
fn header(capture: &Path) -> serde_json::Value {
    let bytes = fs::read(capture).expect("a capture");
    let line = bytes.split(|&byte| byte == b'\n').nth(1);
    serde_json::from_slice(line.expect("a header")).expect("JSON")
}

#[test]
fn other_settings_begin_another_recording_and_both_are_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let mut served = Served::start(&capture, 3600);
    let mut tab = served.tab();
    wait_for(&mut tab, "2000 samples/s");
    assert_eq!(served.command("record", &settings("500")), 204);
    wait_for(&mut tab, "run-2.inmcap   500 samples/s");
    // Marks go to the one that goes on.
    assert_eq!(served.command("mark", "second"), 204);
    wait_for(&mut tab, ": second");
    assert_eq!(served.command("end", ""), 204);
    let said = served.end();
    let other = folder.path().join("run-2.inmcap");
    for (file, rate_hz, phase, marked) in [
        (&capture, 2000.0, "Linear", false),
        (&other, 500.0, "Minimum", true),
    ] {
        let header = header(file);
        assert_eq!(header["rate_hz"], rate_hz);
        let filter = header["settings"]["filter"].to_string();
        assert!(filter.contains(phase), "{filter}");
        let source = source(file);
        assert_eq!(source["gaps"], serde_json::json!([]));
        let news = source["news"].to_string();
        assert_eq!(news.contains(": second"), marked, "{news}");
        // One that was not brought to its end would be said to be cut.
        assert!(!news.contains("cut"), "{news}");
        let name = file.file_name().expect("a name").to_string_lossy();
        assert!(said.contains(&format!("{name}   ")), "{said}");
    }
}

#[test]
fn a_board_that_rests_tests_itself_and_records_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let served = Served::start(&capture, 3600);
    let mut tab = served.tab();
    wait_for(&mut tab, "Recording into");
    // Not while it records: the sensors move.
    assert_eq!(served.command("selftest", ""), 409);
    assert_eq!(served.command("stop", ""), 204);
    wait_for(&mut tab, "Stopped: the board rests");
    let length = fs::metadata(&capture).expect("a capture").len();
    for (what, body) in [("stop", ""), ("mark", "late")] {
        assert_eq!(served.command(what, body), 409, "{what}");
    }
    assert_eq!(served.command("selftest", ""), 204);
    wait_for(&mut tab, "The board tests itself");
    let tested = wait_for(&mut tab, "selftest");
    for part in [
        "step Z",
        "rest X",
        "noise Y",
        "clock",
        "Stopped: the board rests",
    ] {
        assert!(tested.contains(part), "no {part}: {tested}");
    }
    assert_eq!(fs::metadata(&capture).expect("a capture").len(), length);
    assert_eq!(served.command("record", &settings("4000")), 204);
    wait_for(&mut tab, "run-2.inmcap   4000 samples/s");
    served.stop();
}

#[test]
fn what_cannot_be_is_refused_and_costs_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).expect("a folder");
    let mut served = Served::start(&inner.join("run.inmcap"), 3600);
    let mut tab = served.tab();
    wait_for(&mut tab, "Recording into");
    for body in [&settings("3000"), "", "{}", "\u{1b}"] {
        assert_eq!(served.command("record", body), 422, "{body}");
    }
    for what in ["record", "selftest", "stop", "end"] {
        for from in ["Origin: http://evil.example", "Sec-Fetch-Site: cross-site"] {
            let request = served.request("POST", what, &[from], &settings("500"));
            assert_eq!(served.status(&request), 403, "{what}, {from}");
        }
        let request = served.request("GET", what, &[], "");
        assert_eq!(served.status(&request), 405, "{what}");
    }
    // A recording that cannot be begun leaves the bench as it is, and says why.
    fs::remove_dir_all(&inner).expect("removed");
    assert_eq!(served.command("record", &settings("500")), 204);
    let said = wait_for(&mut tab, "not started");
    assert!(said.contains("creating the capture"), "{said}");
    assert_eq!(served.command("end", ""), 204);
    served.end();
}

/// A port is locked by who has it open: the recording that ends gives it back to the one that begins.
#[test]
fn a_board_behind_a_port_is_started_again_and_again() {
    let board = PtyBoard::start(VirtualConnect::published(1, 1.0));
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let mut served = Served::on(&[&board.port], &capture, 3600);
    let mut tab = served.tab();
    wait_for(&mut tab, "run.inmcap   2000 samples/s");
    for (number, rate) in [(2, "500"), (3, "1000")] {
        assert_eq!(served.command("record", &settings(rate)), 204);
        wait_for(&mut tab, &format!("run-{number}.inmcap   {rate} samples/s"));
    }
    assert_eq!(served.command("end", ""), 204);
    // Behind a terminal a busy machine loses samples, as it does behind a UART: 1 is as good as 0 here.
    let (status, said) = served.ended();
    assert!(matches!(status, Some(0 | 1)), "{status:?}: {said}");
    for (name, rate_hz) in [("run", 2000.0), ("run-2", 500.0), ("run-3", 1000.0)] {
        let capture = folder.path().join(name).with_extension("inmcap");
        assert_eq!(header(&capture)["rate_hz"], rate_hz, "{name}");
        let news = source(&capture)["news"].to_string();
        assert!(!news.contains("cut"), "{name}: {news}");
    }
}
