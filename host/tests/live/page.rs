//! The page: who is let in, what tabs get, and that no tab costs a sample.

use std::io::Read;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use crate::served::{PATIENCE, Served, source, wait_for};

#[test]
fn who_has_no_business_here_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let served = Served::start(&folder.path().join("run.inmcap"), 600);
    let ask = |method: &str, what: &str, headers: &[&str], body: &str| {
        served.status(&served.request(method, what, headers, body))
    };
    assert_eq!(ask("GET", "", &[], ""), 200);
    let host = &served.host;
    let raw = |path: &str| served.status(&format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n"));
    // Another token, or none.
    for path in [
        "/",
        "/events",
        "/00000000000000000000000000000000/",
        "//",
        "/live.js",
    ] {
        assert_eq!(raw(path), 403, "{path}");
    }
    // Another name, another page.
    let named = |host: &str| {
        served.status(&format!(
            "GET {} HTTP/1.1\r\nHost: {host}\r\n\r\n",
            served.path
        ))
    };
    assert_eq!(named("evil.example"), 403);
    let evil = "Origin: http://evil.example";
    assert_eq!(ask("POST", "stop", &[evil], ""), 403);
    assert_eq!(
        ask("POST", "mark", &["Sec-Fetch-Site: cross-site"], "x"),
        403
    );
    // No command is taken from who does not know the token, or the name.
    for command in ["mark", "stop", "record", "selftest", "end"] {
        let posted = |path: &str, host: &str| {
            let head = format!("POST {path}{command} HTTP/1.1\r\nHost: {host}\r\n");
            served.status(&format!("{head}Content-Length: 0\r\n\r\n"))
        };
        for path in ["/", "//", "/00000000000000000000000000000000/"] {
            assert_eq!(posted(path, host), 403, "{path}{command}");
        }
        assert_eq!(posted(&served.path, "evil.example"), 403, "{command}");
    }
    // Paths that lead elsewhere lead nowhere.
    for what in [
        "../",
        "..%2f..%2fetc/passwd",
        "live.js/",
        "//live.js",
        "stop/../live.js",
    ] {
        assert_eq!(ask("GET", what, &[], ""), 404, "{what}");
    }
    assert_eq!(ask("GET", "stop", &[], ""), 405);
    assert_eq!(ask("POST", "", &[], ""), 405);
    // Too much of anything.
    assert_eq!(ask("POST", "mark", &[], &"x".repeat(10_000)), 413);
    assert_eq!(ask("POST", "mark", &[], &"x".repeat(200)), 422);
    assert_eq!(ask("GET", &"x".repeat(100_000), &[], ""), 414);
    let header = format!("X: {}", "x".repeat(1_000_000));
    assert_eq!(ask("GET", "", &[&header], ""), 431);
    // None of it ended or marked anything.
    let mut tab = served.tab();
    let parts = wait_for(&mut tab, "nothing has happened so far");
    assert!(!parts.contains("mark ahead"), "{parts}");
    served.stop();
}

#[test]
fn one_tab_too_many_is_refused_until_another_is_closed() {
    let folder = tempfile::tempdir().expect("a folder");
    let served = Served::start(&folder.path().join("run.inmcap"), 600);
    let mut tabs: Vec<_> = (0..16).map(|_| served.tab()).collect();
    for tab in &mut tabs {
        wait_for(tab, "event: parts");
    }
    let another = || served.status(&served.request("GET", "events", &[], ""));
    assert_eq!(another(), 503);
    tabs.pop();
    let deadline = Instant::now() + PATIENCE;
    while another() != 200 {
        assert!(Instant::now() < deadline, "a closed tab is still counted");
        thread::sleep(Duration::from_millis(50));
    }
    drop(tabs);
    served.stop();
}

#[test]
fn tabs_cost_no_sample_whatever_they_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let mut served = Served::start(&capture, 300);
    let (mut tab, mut other) = (served.tab(), served.tab());
    // Never read again: its buffers fill, and it is skipped.
    let mut slow = served.tab();
    slow.read_exact(&mut [0; 512]).expect("its beginning");
    wait_for(&mut tab, "<svg");
    wait_for(&mut other, "<svg");
    drop(other);
    assert_eq!(
        served.status(&served.request("POST", "mark", &[], "door")),
        204
    );
    wait_for(&mut tab, "mark ahead of sample");
    // Opened again it has all of it.
    let mut again = served.tab();
    let parts = wait_for(&mut again, "mark ahead of sample");
    assert!(parts.contains("Allan deviation"), "{parts}");
    drop(again);
    // Who reads hears of the end.
    wait_for(&mut tab, "event: end");
    served.end();
    let source = source(&capture);
    assert_eq!(source["gaps"], serde_json::json!([]));
    assert!(source["samples"].as_u64() >= Some(600_000), "{source}");
    assert!(source["news"].to_string().contains(": door"), "{source}");
}

#[test]
fn an_address_that_cannot_be_is_said_before_anything_is_recorded() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("an address");
    let taken = taken.local_addr().expect("an address").to_string();
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    for (address, why) in [
        (taken.as_str(), "another port"),
        ("0.0.0.0:0", "the one by which browsers reach it"),
        ("localhost", "invalid socket address"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_inm"))
            .args([
                "live",
                "--source",
                "virtual",
                &format!("--page={address}"),
                "-o",
            ])
            .arg(&capture)
            .output()
            .expect("inm runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(address) && said.contains(why), "{said}");
        assert!(!capture.exists(), "{address}");
    }
}
