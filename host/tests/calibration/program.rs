//! `inm calibrate` as a user runs it, against virtual boards whose block somebody turns.

use std::path::Path;

use inm_emulator::sensor::{Coefficients, GRAVITY_M_S2};
use inm_host::internals::calibrate::Unsteady;
use inm_host::internals::capture::Reader;
use inm_host::internals::inspect::{Readings, Session};
use inm_host::internals::link::{Connect, Patience};
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::{Chunk, Source, Values};
use inm_host::internals::virtual_board::{Truth, Turned, VirtualConnect};
use inm_protocol::{SensorCalibration, SensorRange};
use serde_json::Value;

use crate::bench::{
    Bench, STEADY, behind_the_filter, bench, inm, next, parameters, session, show, sound, text,
};
use crate::pty::PtyBoard;

/// Of nine parameters of a session one is beyond five deviations once in 190 000 sessions.
const DEVIATIONS: f64 = 5.0 / 1.96;

#[test]
fn both_ranges_are_found_kept_and_used_by_every_record() {
    const SEED: u64 = 11;
    let Bench {
        truth,
        block,
        connect,
    } = bench(SEED);
    for (name, range) in [("12", SensorRange::G12), ("4", SensorRange::G4)] {
        let board = PtyBoard::start(connect.clone());
        let options = ["--range", name, "--positions", "14"];
        let hand = || block.hand(14, GRAVITY_M_S2, SEED);
        let (found, _) = sound(&board.port, &options, hand);
        let expected = behind_the_filter(truth.parameters(range));
        for (at, [value, half_width]) in parameters(&found).into_iter().enumerate() {
            let off = (value - expected[at]).abs() / half_width;
            assert!(
                off < DEVIATIONS,
                "seed {SEED}, {name} g, parameter {at}: {off} half intervals"
            );
        }
        let kept = show(&board.port, name).expect("kept");
        let record: SensorCalibration =
            serde_json::from_value(found["record"].clone()).expect("a record");
        assert_eq!(kept, record, "seed {SEED}");
        drop(board);
        used(&connect, &block, &kept, SEED);
    }
    // The other range's is still there.
    let board = PtyBoard::start(connect);
    assert!(show(&board.port, "12").is_some(), "seed {SEED}");
    let erased = inm(&[
        "calibrate",
        "--port",
        &board.port,
        "--erase",
        "--range",
        "12",
    ]);
    assert!(erased.status.success(), "{}", text(&erased.stderr));
    assert_eq!(show(&board.port, "12"), None);
    assert!(show(&board.port, "4").is_some(), "seed {SEED}");
}

/// A record of the board, which is another life of it, is by what it keeps: X up reads gravity.
fn used(connect: &VirtualConnect, block: &Turned, kept: &SensorCalibration, seed: u64) {
    block.put([GRAVITY_M_S2, 0.0, 0.0]);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.inmcap");
    let plan = Plan {
        range: Some(kept.range),
        samples: Some(8000),
        ..Plan::default()
    };
    let board = Box::new(connect.clone());
    let mut source =
        BoardSource::start(board, plan, Some(&file), Stop::default()).expect("a board");
    let axis = source.signal().axes[0].clone();
    let (mut sum, mut number) = (0.0, 0.0);
    while let Some(chunk) = source.next_chunk().expect("no loss") {
        if let Chunk::Samples(block) = chunk {
            let Values::Codes(codes) = &block.columns[0].values else {
                panic!("a board sends codes");
            };
            sum += codes.iter().map(|&code| f64::from(code)).sum::<f64>();
            number += codes.len() as f64;
        }
    }
    let reading = axis.scale * (sum / number - axis.zero);
    // Deviations of what is kept, and of the mean of 4 s (white noise, and the ends of the differenced).
    let scale = f64::from(kept.row_deviations[0]) / f64::from(kept.rows[0]);
    let zero = f64::from(kept.zero_deviations[0]) * axis.scale;
    let mean = (STEADY.white.powi(2) / 4.0 + 2.0 * (STEADY.quantisation / 4.0).powi(2)).sqrt();
    let deviation = (GRAVITY_M_S2 * scale).hypot(zero).hypot(mean);
    let off = (reading - GRAVITY_M_S2).abs() / deviation;
    assert!(off < 5.0, "seed {seed}, {:?}: {off} deviations", kept.range);
    assert_eq!(header(&file), Some(*kept), "seed {seed}");
}

fn header(file: &Path) -> Option<SensorCalibration> {
    let reader = Reader::open(file).expect("a capture");
    reader.header().calibration
}

#[test]
fn a_position_that_is_wrong_is_named_and_nothing_is_kept() {
    const SEED: u64 = 12;
    const WRONG: usize = 9;
    let Bench { block, connect, .. } = bench(SEED);
    let board = PtyBoard::start(connect);
    let mut hand = block.hand(18, GRAVITY_M_S2, SEED);
    let (found, words) = session(&board.port, &[], &[1], |number| {
        next(&mut hand);
        if number == WRONG {
            // Something pulls: half a thousandth of gravity, some fifty deviations.
            block.put(block.felt().map(|felt| 1.0005 * felt));
        }
    });
    assert_eq!(
        found["doubts"][0]["position"], WRONG,
        "seed {SEED}: {found:#} {words}"
    );
    assert_eq!(found["stored"], false);
    assert_eq!(show(&board.port, "4"), None);
}

#[test]
fn a_position_that_was_there_already_is_asked_for_again() {
    const SEED: u64 = 13;
    let Bench { block, connect, .. } = bench(SEED);
    let board = PtyBoard::start(connect);
    let mut hand = block.hand(12, GRAVITY_M_S2, SEED);
    let options = ["--positions", "12", "--dry-run"];
    let mut prompts = 0;
    let (found, words) = session(&board.port, &options, &[0, 1], |number| {
        prompts = number;
        // The third time the block stays where it is.
        if number != 3 {
            next(&mut hand);
        }
    });
    assert_eq!(prompts, 13, "seed {SEED}");
    assert!(
        words.contains("this is position 2 once more"),
        "seed {SEED}: {words}"
    );
    assert_eq!(found["positions"], 12, "seed {SEED}");
    assert_eq!(found["stored"], false, "it was only asked for");
    assert_eq!(show(&board.port, "4"), None);
}

#[test]
fn a_block_that_moves_while_it_is_read_is_noticed() {
    const SEED: u64 = 14;
    let Bench { block, connect, .. } = bench(SEED);
    let mut connect = VirtualConnect {
        // In real time, or it would be over before it moves.
        speed: 4.0,
        ..connect
    };
    let opened = Session::open(&mut connect, Patience::default());
    let (mut session, identity) = opened.expect("a virtual board");
    let port = connect.name();
    let begun = Readings::begin(&mut session, port, &identity, SensorRange::G4);
    let (mut readings, _) = begun.expect("a board at rest");
    let still = readings.stretch(4.0).expect("a stream").position(None);
    assert!(still.is_ok(), "seed {SEED}: {still:?}");
    let mover = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(600));
        block.put([0.05, 0.0, GRAVITY_M_S2]);
    });
    let moved = readings.stretch(4.0).expect("a stream").position(None);
    mover.join().expect("no panic");
    assert!(
        matches!(moved, Err(Unsteady::Moved { axis: 'X', .. })),
        "seed {SEED}: {moved:?}"
    );
}

#[test]
fn what_was_kept_stays_where_a_session_is_given_up() {
    const SEED: u64 = 15;
    let Bench { block, connect, .. } = bench(SEED);
    let board = PtyBoard::start(connect);
    let hand = || block.hand(12, GRAVITY_M_S2, SEED);
    sound(&board.port, &["--positions", "12"], hand);
    let kept = show(&board.port, "4");
    assert!(kept.is_some(), "seed {SEED}");
    let given_up = inm(&["calibrate", "--port", &board.port]);
    assert_eq!(given_up.status.code(), Some(2));
    let said = text(&given_up.stderr);
    assert!(
        said.contains("the input ended ahead of position 1 of 18"),
        "{said}"
    );
    assert_eq!(show(&board.port, "4"), kept, "seed {SEED}");
}

#[test]
fn a_second_session_tells_what_became_of_the_first() {
    const SEED: u64 = 16;
    let Bench { block, connect, .. } = bench(SEED);
    let board = PtyBoard::start(connect);
    let options = ["--positions", "12"];
    let [first, second] = [SEED, SEED + 1]
        .map(|seed| sound(&board.port, &options, || block.hand(12, GRAVITY_M_S2, seed)));
    assert!(first.0["since"].is_null(), "seed {SEED}: {:#}", first.0);
    let since = &second.0["since"];
    assert_eq!(since["unix_s"], first.0["record"]["unix_s"], "seed {SEED}");
    let [was, is] = [&first.0, &second.0].map(parameters);
    for (at, (was, is)) in was.into_iter().zip(is).enumerate() {
        let change = &since["changes"][at];
        let number = |key: &str| change[key].as_f64().expect("a number");
        // What is kept is rounded to 1e-16 m/s^2 per count and to counts, some 1e-8 each.
        let difference = is[0] - was[0];
        assert!(
            (number("difference") - difference).abs() < 1e-7,
            "seed {SEED}: {change}, {difference}"
        );
        // The sensors are the same: one parameter of nine is beyond five deviations once in 190 000 sessions.
        assert!(number("deviations").abs() < 5.0, "seed {SEED}: {change}");
    }
}

/// As it is shown to who has no board.
#[test]
fn the_virtual_board_calibrates_itself() {
    let arguments = [
        "calibrate",
        "--port",
        "virtual",
        "--seed",
        "3",
        "--positions",
        "12",
    ];
    let output = inm(&[&arguments[..], &["--seconds", "2", "--json", "-"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let truth = Truth::draw(Coefficients::PUBLISHED, 3).parameters(SensorRange::G4);
    let truth = behind_the_filter(truth);
    for (at, [value, half_width]) in parameters(&found).into_iter().enumerate().take(6) {
        let off = (value - truth[at]).abs() / half_width;
        assert!(
            off < DEVIATIONS,
            "seed 3, parameter {at}: {off} half intervals"
        );
    }
}
