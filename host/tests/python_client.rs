//! The reference client in Python against the host: the samples of both are the same to the bit, from
//! captures and live.
#![cfg(unix)]

#[path = "python_client/later.rs"]
mod later;
mod pty;
#[path = "python_client/troubled.rs"]
mod troubled;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

use inm_host::internals::source::audit::State;
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::source::{Block, Chunk, Source, Values};
use inm_host::internals::virtual_board::{VirtualConnect, Witness};
use inm_protocol::ToHost;
use later::ConnectLater;
use pty::PtyBoard;
use troubled::{Change, changed, troubled};

const SEED: u64 = 21;

/// The interpreter, if there is one of a version that the client needs; says so past the test
/// harness if there is none, since a test that is passed over otherwise looks like one that passed.
fn python() -> Option<&'static str> {
    let version = "import sys; sys.exit(sys.version_info < (3, 8))";
    let found = Command::new("python3").args(["-c", version]).status();
    if found.is_ok_and(|status| status.success()) {
        return Some("python3");
    }
    let line = "NOT TESTED: there is no python3 (3.8 or later) here, and so no look at \
                protocol/python/inm_client.py\n";
    let _ = std::io::stderr().write_all(line.as_bytes());
    None
}

fn client(python: &str, arguments: &[&str]) -> Output {
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../protocol/python/inm_client.py"
    );
    let output = Command::new(python).arg(script).args(arguments).output();
    output.expect("python3 runs")
}

/// What the client prints.
#[track_caller]
fn printed(output: Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    String::from_utf8(output.stdout).expect("text")
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests/golden")
        .join(name)
}

/// The samples that the host makes of a capture, as the client writes them.
fn host_csv(capture: &Path) -> String {
    let mut source = CaptureSource::open(capture).expect("a capture");
    let mut csv = "index,x,y,z\n".to_owned();
    while let Some(chunk) = source.next_chunk().expect("samples") {
        if let Chunk::Samples(block) = chunk {
            (0..block.len()).for_each(|at| line(&mut csv, &block, at));
        }
    }
    csv
}

fn line(csv: &mut String, block: &Block, at: usize) {
    write!(csv, "{}", block.first + at as u64).expect("a string takes it");
    for column in &block.columns {
        let Values::Codes(codes) = &column.values else {
            panic!("a capture holds codes");
        };
        csv.push(',');
        if !column.invalid.iter().any(|range| range.contains(&at)) {
            write!(csv, "{}", codes[at]).expect("a string takes it");
        }
    }
    csv.push('\n');
}

/// Equal line by line, so that a failure shows the first that is not.
#[track_caller]
fn assert_same(python: &str, host: &str) {
    let differs = python.lines().zip(host.lines()).find(|(a, b)| a != b);
    assert_eq!(differs, None, "client and host");
    assert_eq!(python.lines().count(), host.lines().count());
}

/// Of both versions; with gaps, flags, notices, damaged frames and a restart in them.
#[test]
fn the_client_reads_from_old_captures_what_the_host_reads() {
    let Some(python) = python() else { return };
    for name in ["board.inmcap", "board-2.inmcap"] {
        let path = golden(name);
        let samples = printed(client(python, &["samples", &path.display().to_string()]));
        let host = host_csv(&path);
        // It is worth something only if words are left out and conversions are missing.
        assert!(host.contains(",,"), "{name}");
        assert!(host.lines().count() > 1000, "{name}");
        assert_same(&samples, &host);
    }
}

#[test]
fn the_client_reads_from_a_new_capture_what_the_host_reads() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.inmcap");
    let name = path.display().to_string();
    let seed = SEED.to_string();
    let recorded = Command::new(env!("CARGO_BIN_EXE_inm"))
        .args([
            "record",
            "--source",
            "virtual",
            "--duration",
            "3",
            // A message that the client has no use for.
            "--pps",
            "-o",
            &name,
            "--seed",
            &seed,
        ])
        .output();
    assert!(recorded.expect("inm runs").status.success(), "seed {seed}");
    let samples = printed(client(python, &["samples", &name]));
    assert!(samples.lines().count() > 6000);
    assert_same(&samples, &host_csv(&path));
    // The board's digests, from what WIRE.md says of them alone.
    let proof: serde_json::Value =
        serde_json::from_str(&printed(client(python, &["proof", &name]))).expect("JSON");
    let proven = proven_by_host(&path);
    assert!(proven > 6000, "{proven}");
    assert_eq!(
        proof,
        serde_json::json!({"proven": proven, "disagreements": 0})
    );
    // One word that is another: nothing behind it is proven.
    let changed = changed(
        &std::fs::read(&path).expect("there"),
        |_| true,
        |message| {
            if let ToHost::Samples(batch) = message
                && batch.seq == 80
            {
                batch.codes[3][1].0 ^= 1;
            }
        },
    );
    std::fs::write(&path, changed).expect("written");
    let proof: serde_json::Value =
        serde_json::from_str(&printed(client(python, &["proof", &name]))).expect("JSON");
    assert!(proof["proven"].as_u64() < Some(80 * 32 + 4), "{proof}");
    assert!(proof["disagreements"].as_u64() > Some(0), "{proof}");
}

/// The conversion up to which the host holds a capture for proven.
fn proven_by_host(capture: &Path) -> u64 {
    let mut source = CaptureSource::open(capture).expect("a capture");
    while source.next_chunk().expect("samples").is_some() {}
    match source.proof().expect("of a board").state {
        State::Proven { epoch: 0, index } => index,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_client_records_from_a_port_what_the_host_reads_and_the_converters_sent() {
    let Some(python) = python() else { return };
    let witness = Witness::default();
    let board = PtyBoard::start(VirtualConnect {
        witness: Some(Arc::clone(&witness)),
        // Slower than a terminal is read: what finds no room in it is lost.
        ..VirtualConnect::published(SEED, 2.0)
    });
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.inmcap");
    let name = path.display().to_string();
    let samples = ["--samples", "4000", "--rate", "1000"];
    let live = client(
        python,
        &[&["record", &board.port, &name][..], &samples].concat(),
    );
    let live = printed(live);
    assert!(live.lines().count() > 4000, "seed {SEED}");
    assert_same(&live, &host_csv(&path));
    assert_same(&live, &printed(client(python, &["samples", &name])));

    let words = witness.lock().expect("no panic");
    let first = live.lines().nth(1).expect("a sample");
    let code = |word: u32| word.cast_signed().to_string();
    let cells: Vec<&str> = first.split(',').skip(1).collect();
    // Readings are dropped until the filters have settled, as often as a start is tried.
    let begin = words
        .iter()
        .position(|sent| sent.map(code).iter().eq(&cells));
    let begin = begin.expect("the first sample was sent by the converters");
    for (line, sent) in live.lines().skip(1).zip(&words[begin..]) {
        let cells: Vec<&str> = line.split(',').skip(1).collect();
        assert!(
            sent.map(code).iter().eq(&cells),
            "seed {SEED}: {line} is not {sent:?}"
        );
    }
}

/// A slip, a converter that stops and a restart: whole, cut, without its notices, and with frames
/// missing.
#[test]
fn the_client_leaves_out_of_a_troubled_capture_what_the_host_leaves_out() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.inmcap");
    troubled(&path);
    let capture = std::fs::read(&path).expect("written");
    let no_events: Change = |message| !matches!(message, ToHost::Event(_));
    let no_ends: Change = |message| !matches!(message, ToHost::Reply(_) | ToHost::Note(_));
    let some_lost: Change = |message| !matches!(message, ToHost::Samples(b) if b.seq % 37 == 5);
    let mut seen = vec![];
    for (name, bytes) in [
        ("whole", capture.clone()),
        ("cut", capture[..capture.len() * 2 / 5].to_vec()),
        ("no notice", changed(&capture, no_events, |_| {})),
        ("no reply and no note", changed(&capture, no_ends, |_| {})),
        ("batches lost", changed(&capture, some_lost, |_| {})),
    ] {
        std::fs::write(&path, bytes).expect("written");
        let samples = printed(client(python, &["samples", &path.display().to_string()]));
        assert_same(&samples, &host_csv(&path));
        assert!(samples.contains(",,"), "{name}");
        // Each leaves out something else, or the change is none.
        assert!(!seen.contains(&samples), "{name} is as one before it");
        seen.push(samples);
    }
}

#[test]
fn a_board_of_a_version_to_come_is_named_by_host_and_client() {
    let board = PtyBoard::start(ConnectLater);
    let folder = tempfile::tempdir().expect("a folder");
    let name = folder.path().join("run.inmcap").display().to_string();
    let arguments = ["record", "--source", &board.port, "-o", &name];
    let host = Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(arguments)
        .output();
    let mut said = vec![host.expect("inm runs")];
    if let Some(python) = python() {
        said.push(client(python, &["identify", &board.port]));
    }
    for output in said {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success(), "{said}");
        for part in ["version 9", "9.1.0", "stm32f405", "inm flash", &board.port] {
            assert!(said.contains(part), "`{part}` is not in: {said}");
        }
    }
}

#[test]
fn the_client_names_what_it_cannot_read() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path.display().to_string()
    };
    for (path, expected) in [
        (write("a", "index,x\n1,2\n"), "not a capture"),
        (
            write("b", "#inm-capture 1\n{\"protocol\":77}\n"),
            "protocol version 77",
        ),
    ] {
        let output = client(python, &["samples", &path]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success());
        assert!(said.contains(expected) && said.contains(&path), "{said}");
    }
}
