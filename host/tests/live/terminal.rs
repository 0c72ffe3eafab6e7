//! The view that takes the whole terminal, on a pseudo terminal: what is drawn, what keys do, and that
//! the terminal is given back.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use rustix::termios::{LocalModes, OptionalActions, Winsize, tcgetattr, tcsetattr, tcsetwinsize};
use serialport::{SerialPort, TTYPort};

/// Longest wait for anything: a busy machine takes its time, and a defect for ever.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// What leaves the other page of a terminal (xterm control sequences, private mode 1049).
const OWN_PAGE: &str = "\u{1b}[?1049l";

/// What a shell leaves to the terminal: to show what is typed, to take it line by line, and Ctrl-C.
const SHELL: LocalModes = LocalModes::ECHO
    .union(LocalModes::ICANON)
    .union(LocalModes::ISIG);

/// A terminal with a recording on it.
pub struct Bench {
    keys: TTYPort,
    /// The program's side, held open.
    terminal: File,
    child: Child,
    /// What was drawn since the last that was waited for.
    pub drawn: String,
}

impl Bench {
    /// Records a virtual board on a terminal of so many columns and rows.
    fn start(capture: &Path, size: [u16; 2]) -> Self {
        let mut live = Command::new(env!("CARGO_BIN_EXE_inm"));
        live.args(["live", "--source", "virtual", "--duration", "600", "-o"])
            .arg(capture);
        Self::on_terminal(&mut live, size)
    }

    /// Runs `command` on a terminal of so many columns and rows.
    pub fn on_terminal(command: &mut Command, size: [u16; 2]) -> Self {
        let (mut keys, slave) = TTYPort::pair().expect("a pseudo terminal");
        keys.set_timeout(Duration::from_millis(50)).expect("set");
        let path = slave.name().expect("it has a path");
        let terminal = OpenOptions::new().read(true).write(true).open(path);
        let terminal = terminal.expect("it opens");
        let mut modes = tcgetattr(&terminal).expect("modes");
        modes.local_modes |= SHELL;
        tcsetattr(&terminal, OptionalActions::Now, &modes).expect("set");
        resize(&terminal, size);
        let side = || terminal.try_clone().expect("a copy");
        Self {
            keys,
            child: command
                .stdin(side())
                .stdout(side())
                .stderr(side())
                .spawn()
                .expect("inm runs"),
            terminal,
            drawn: String::new(),
        }
    }

    /// Makes the terminal another size.
    pub fn resize(&self, size: [u16; 2]) {
        resize(&self.terminal, size);
    }

    pub fn press(&mut self, keys: &str) {
        self.keys.write_all(keys.as_bytes()).expect("pressed");
    }

    /// Waits until `text` is drawn in one go after all that was waited for before.
    #[track_caller]
    pub fn wait_for(&mut self, text: &str) {
        let deadline = Instant::now() + PATIENCE;
        loop {
            if let Some(at) = self.drawn.find(text) {
                self.drawn.drain(..at + text.len());
                return;
            }
            assert!(Instant::now() < deadline, "no `{text}` in {}", self.drawn);
            self.read();
        }
    }

    /// Waits until a mark is in the capture, where its text stands as it is. What is drawn are
    /// the cells that change, which are no words.
    #[track_caller]
    fn wait_for_mark(&mut self, capture: &Path, text: &str) {
        let deadline = Instant::now() + PATIENCE;
        let is_there = || {
            let bytes = std::fs::read(capture).expect("the capture");
            bytes
                .windows(text.len())
                .any(|part| part == text.as_bytes())
        };
        while !is_there() {
            assert!(Instant::now() < deadline, "no mark `{text}`");
            self.read();
        }
    }

    /// Reads what there is to read.
    pub fn read(&mut self) {
        let mut bytes = [0; 4096];
        match self.keys.read(&mut bytes) {
            Ok(len) => self.drawn += &String::from_utf8_lossy(&bytes[..len]),
            Err(error) => assert_eq!(error.kind(), ErrorKind::TimedOut),
        }
    }

    /// What the program printed after it gave the terminal back and ended in good order.
    pub fn end(mut self) -> String {
        self.wait_for(OWN_PAGE);
        let deadline = Instant::now() + PATIENCE;
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("our child") {
                break status;
            }
            assert!(Instant::now() < deadline, "it does not end");
            // A terminal that nobody reads holds what is written to it.
            self.read();
        };
        self.read();
        assert!(status.success(), "{status:?}: {}", self.drawn);
        let modes = tcgetattr(&self.terminal).expect("modes").local_modes;
        assert!(modes.contains(SHELL), "{modes:?}");
        std::mem::take(&mut self.drawn)
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        // A test that has failed leaves nothing behind.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Gives a terminal so many columns and rows.
fn resize(terminal: &File, [columns, rows]: [u16; 2]) {
    let size = Winsize {
        ws_row: rows,
        ws_col: columns,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    tcsetwinsize(terminal, size).expect("a size");
}

#[test]
fn a_moment_is_marked_and_the_recording_ended_by_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let mut bench = Bench::start(&capture, [80, 24]);
    bench.wait_for("m mark");
    bench.press("mfan on\r");
    bench.wait_for_mark(&capture, "fan on");
    bench.press("qy");
    let printed = bench.end();
    assert!(printed.contains("white noise"), "{printed}");

    let analysed = Command::new(env!("CARGO_BIN_EXE_inm"))
        .arg("analyze")
        .arg(&capture)
        .args(["--json", "-"])
        .output()
        .expect("inm runs");
    let json: serde_json::Value = serde_json::from_slice(&analysed.stdout).expect("JSON");
    let news = json["source"]["news"].to_string();
    assert!(news.contains("mark ahead of sample"), "{news}");
    assert!(news.contains(": fan on"), "{news}");
    assert_eq!(json["source"]["gaps"], serde_json::json!([]), "{news}");
}

#[test]
fn a_terminal_that_is_resized_is_filled_anew_and_control_c_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bench = Bench::start(&folder.path().join("run.inmcap"), [80, 24]);
    bench.wait_for("m mark");
    bench.resize([120, 40]);
    // The keys stand on the last row, whichever that is.
    bench.wait_for("\u{1b}[40;");
    bench.wait_for("m mark");
    bench.press("\u{3}");
    bench.end();
}
