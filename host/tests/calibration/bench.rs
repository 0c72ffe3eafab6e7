//! Boards on a block that somebody turns, and sessions of `inm calibrate` with them.

use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Output, Stdio};

use inm_emulator::Phase;
use inm_emulator::response::Response;
use inm_emulator::sensor::Coefficients;
use inm_host::internals::calibrate::PARAMETERS;
use inm_host::internals::virtual_board::{Hand, Truth, Turned, VirtualConnect};
use inm_protocol::{SensorCalibration, Settings};
use serde_json::Value;

/// Sensors whose zeros stay: between the last position and the look at the truth a board that runs as fast
/// as it goes would let them wander on.
pub const STEADY: Coefficients = Coefficients {
    ramp: 0.0,
    walk: 0.0,
    flicker: 0.0,
    white: 1.05e-4,
    quantisation: 2.25e-4,
};

pub fn inm(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .expect("inm runs")
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A board on a block, and what is true of it.
pub struct Bench {
    pub truth: Truth,
    pub block: Turned,
    pub connect: VirtualConnect,
}

pub fn bench(seed: u64) -> Bench {
    let truth = Truth::draw([STEADY; 3], seed);
    let board = VirtualConnect::published(seed, 0.0);
    let (connect, block) = board.turning(&truth, seed).expect("noise that fits");
    Bench {
        truth,
        block,
        connect,
    }
}

/// Runs a session in which `turn` is called with each prompt's number, from 1, and which may end with these statuses;
/// its JSON and its words.
pub fn session(
    port: &str,
    more: &[&str],
    statuses: &[i32],
    mut turn: impl FnMut(usize),
) -> (Value, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(["calibrate", "--port", port, "--json", "-", "--seconds", "3"])
        .args(more)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("inm runs");
    let mut keys = child.stdin.take().expect("piped");
    let said = BufReader::new(child.stderr.take().expect("piped"));
    let (mut prompts, mut words) = (0, String::new());
    for line in said.lines() {
        let line = line.expect("text");
        if line.contains("press Enter") {
            prompts += 1;
            turn(prompts);
            keys.write_all(b"\n").expect("it listens");
        }
        words += &format!("{line}\n");
    }
    let output = child.wait_with_output().expect("it ends");
    let status = output.status.code().expect("it ends by itself");
    assert!(statuses.contains(&status), "status {status}: {words}");
    let json = serde_json::from_slice(&output.stdout).expect("JSON");
    (json, words)
}

/// Sessions held where one in a hundred has a doubted position by chance, as is meant: behind a terminal no two
/// have the same noise, whatever the seed. All three are doubted once in a million times.
const SESSIONS: usize = 3;

/// A session of a block at rest that ends without a doubt, and is kept.
pub fn sound(port: &str, more: &[&str], hand: impl Fn() -> Hand) -> (Value, String) {
    for _ in 0..SESSIONS {
        let mut hand = hand();
        let told = session(port, more, &[0, 1], |_| next(&mut hand));
        if told.0["stored"] == true {
            return told;
        }
        assert_ne!(told.0["doubts"], Value::Array(Vec::new()), "{}", told.1);
    }
    panic!("{SESSIONS} sessions of a block at rest are doubted");
}

pub fn next(hand: &mut Hand) {
    assert!(hand.turn(), "another position");
}

/// The truth as words have it: the converter's filter passes 1.00003 of a steady input, as the part's own
/// coefficients do, and what is found is of the whole channel.
pub fn behind_the_filter(truth: [f64; PARAMETERS]) -> [f64; PARAMETERS] {
    behind(truth, 6)
}

/// The same of so many numbers of the matrix, the rest zeros.
pub fn behind<const N: usize>(truth: [f64; N], matrix: usize) -> [f64; N] {
    let gain = Response::new(Phase::Linear, Settings::default().rate.hz()).gain(0.0);
    let mut at = 0;
    truth.map(|value| {
        at += 1;
        if at <= matrix {
            value / gain
        } else {
            value * gain
        }
    })
}

/// What was found and its half intervals.
pub fn parameters(found: &Value) -> [[f64; 2]; PARAMETERS] {
    std::array::from_fn(|at| {
        let parameter = &found["parameters"][at];
        ["value", "half_width"].map(|key| parameter[key].as_f64().expect("a number"))
    })
}

pub fn show(port: &str, range: &str) -> Option<SensorCalibration> {
    let output = inm(&[
        "calibrate",
        "--port",
        port,
        "--show",
        "--range",
        range,
        "--json",
        "-",
    ]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let shown: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    serde_json::from_value(shown["calibration"].clone()).expect("a calibration or null")
}
