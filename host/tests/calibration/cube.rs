//! `inm calibrate --cube`: by the estimator alone, on readings of the virtual board's sensors, and by the whole program.

use std::ops::RangeInclusive;

use inm_emulator::sensor::{Coefficients, GRAVITY_M_S2};
use inm_host::internals::calibrate::{CUBE_NAMES, CUBE_PARAMETERS, Face, Position, fit_cube};
use inm_host::internals::virtual_board::{Cube, Truth};
use inm_protocol::{SensorCalibration, SensorRange};
use serde_json::Value;

use crate::bench::{behind, bench, inm, next, session, show, sound, text};
use crate::pty::PtyBoard;
use crate::{Bench, STRETCH_S, read};

/// How far faces are off level, and are stated to be, rad.
const TILT_RAD: f64 = 1e-3;

/// Of twelve parameters of a session one is beyond five deviations once in 145 000 sessions.
const DEVIATIONS: f64 = 5.0 / 1.96;

/// Shares of the sessions whose interval holds the truth, by parameter, and of those with a doubt.
fn coverage(
    noise: [Coefficients; 3],
    tilt_rad: f64,
    seeds: RangeInclusive<u64>,
) -> ([f64; CUBE_PARAMETERS], f64) {
    let (mut inside, mut doubted) = ([0_u32; CUBE_PARAMETERS], 0_u32);
    let runs = (seeds.end() - seeds.start() + 1) as f64;
    for seed in seeds {
        let truth = Truth::draw(noise, seed);
        let mut bench = Bench::new(&truth, noise, seed);
        let cube = Cube::draw(tilt_rad, seed);
        let mut parameters = cube.parameters(&truth, SensorRange::G4);
        let mut hand = cube.hand(&bench.block, GRAVITY_M_S2);
        let (positions, end_s) = read(&mut bench, &mut hand, seed);
        parameters[9..].copy_from_slice(&bench.zeros(STRETCH_S));
        let faces = positions.into_iter().map(|position: Position| {
            let face = Face::of(&position);
            (
                face.unwrap_or_else(|error| panic!("seed {seed}: {error}")),
                position,
            )
        });
        let faces: Vec<(Face, Position)> = faces.collect();
        let found = fit_cube(&faces, GRAVITY_M_S2, tilt_rad, end_s);
        let found = found.unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        for (at, inside) in inside.iter_mut().enumerate() {
            let miss = (found.values[at] - parameters[at]).abs();
            *inside += u32::from(miss <= found.half_widths[at]);
        }
        doubted += u32::from(!found.doubts.is_empty());
    }
    (
        inside.map(|inside| f64::from(inside) / runs),
        f64::from(doubted) / runs,
    )
}

/// Sessions with all noise that is published on cubes that are as level as is stated.
#[test]
fn intervals_hold_the_truth_on_a_cube() {
    const RUNS: u64 = 200;
    let (inside, doubted) = coverage(Coefficients::PUBLISHED, TILT_RAD, 1..=RUNS);
    // Four standard errors of a share, for each of twelve parameters; the study has more sessions.
    let least = 0.95 - 4.0 * (0.95 * 0.05 / RUNS as f64).sqrt();
    for (name, share) in CUBE_NAMES.iter().zip(inside) {
        assert!(share > least, "seeds 1 to {RUNS}: {name} inside in {share}");
    }
    let most = 0.01 + 5.0 * (0.01 / RUNS as f64).sqrt();
    assert!(doubted < most, "seeds 1 to {RUNS}: {doubted} doubted");
}

/// The study: `cargo test -p inm-host --test calibration -- --ignored --nocapture cube`.
#[test]
#[ignore = "a study: minutes of processor time"]
fn coverage_of_two_thousand_sessions_on_a_cube() {
    let published = Coefficients::PUBLISHED;
    let restless = published.map(|axis| Coefficients {
        walk: 3.0 * axis.walk,
        flicker: 3.0 * axis.flicker,
        ..axis
    });
    for (of, noise, tilt_rad) in [
        ("1 mrad, the published sensors", published, 1e-3),
        ("0.05 mrad, the published sensors", published, 5e-5),
        ("5 mrad, the published sensors", published, 5e-3),
        (
            "1 mrad, zeros that wander three times as far",
            restless,
            1e-3,
        ),
        (
            "0.02 mrad, zeros that wander three times as far",
            restless,
            2e-5,
        ),
    ] {
        let (inside, doubted) = coverage(noise, tilt_rad, 2001..=4000);
        println!(
            "{of}, seeds 2001 to 4000, % inside, % doubted {:.2}",
            100.0 * doubted
        );
        for (name, share) in CUBE_NAMES.iter().zip(inside) {
            println!("    {name:<8}{:>6.1}", 100.0 * share);
        }
    }
}

fn parameters(found: &Value) -> Vec<[f64; 2]> {
    let parameters = found["parameters"].as_array().expect("a list");
    let number = |of: &Value, key: &str| of[key].as_f64().expect("a number");
    parameters
        .iter()
        .map(|one| [number(one, "value"), number(one, "half_width")])
        .collect()
}

#[test]
fn a_cube_is_found_in_its_own_frame_and_kept_in_that_of_the_sensors() {
    const SEED: u64 = 21;
    let bench = bench(SEED);
    let board = PtyBoard::start(bench.connect);
    let cube = || Cube::draw(TILT_RAD, SEED);
    let hand = || cube().hand(&bench.block, GRAVITY_M_S2);
    let (found, words) = sound(&board.port, &["--cube"], hand);
    let truth = behind(cube().parameters(&bench.truth, SensorRange::G4), 9);
    let found_of = parameters(&found);
    assert_eq!(found_of.len(), CUBE_PARAMETERS, "{found:#}");
    for (at, [value, half_width]) in found_of.into_iter().enumerate() {
        let off = (value - truth[at]).abs() / half_width;
        assert!(
            off < DEVIATIONS,
            "seed {SEED}, {}: {off} half intervals",
            CUBE_NAMES[at]
        );
    }
    assert_eq!(
        (&found["positions"], &found["freedom"]),
        (&Value::from(6), &Value::from(6))
    );
    // Faces come in any order, and whoever lays down another one is told so.
    assert!(words.contains("as asked: it counts as"), "{words}");
    let kept = show(&board.port, "4").expect("kept");
    let record: SensorCalibration =
        serde_json::from_value(found["record"].clone()).expect("a record");
    assert_eq!(kept, record, "seed {SEED}");
    // What is kept is of the frame that all calibrations of a board are in: the angles between the sensors.
    let truth = behind(bench.truth.parameters(SensorRange::G4), 6);
    let ratio = |at: usize| f64::from(kept.rows[at]) / f64::from(kept.rows[0]);
    for (at, deviation) in kept.row_deviations.iter().enumerate().skip(1) {
        let off = ratio(at) - truth[at] / truth[0];
        let deviation = f64::from(*deviation).hypot(f64::from(kept.row_deviations[0]));
        let allowed = 5.0 * deviation / f64::from(kept.rows[0]);
        assert!(
            off.abs() < allowed,
            "seed {SEED}, row {at}: {off}, {allowed}"
        );
    }
}

#[test]
fn a_face_that_was_there_and_one_that_is_none_are_asked_for_again() {
    const SEED: u64 = 22;
    let bench = bench(SEED);
    let board = PtyBoard::start(bench.connect);
    let mut hand = Cube::draw(TILT_RAD, SEED).hand(&bench.block, GRAVITY_M_S2);
    let mut prompts = 0;
    let (found, words) = session(&board.port, &["--cube", "--dry-run"], &[0, 1], |number| {
        prompts = number;
        match number {
            // The second time the cube stays where it is, the third time it lies on an edge.
            2 => {}
            3 => bench.block.put([
                GRAVITY_M_S2 / 2.0_f64.sqrt(),
                0.0,
                GRAVITY_M_S2 / 2.0_f64.sqrt(),
            ]),
            _ => next(&mut hand),
        }
    });
    assert_eq!(prompts, 8, "seed {SEED}: {words}");
    assert!(
        words.contains("once more, as in position 1: it does not count"),
        "{words}"
    );
    assert!(words.contains("no face of the cube is up"), "{words}");
    assert_eq!(found["positions"], 6, "seed {SEED}");
}

#[test]
fn a_face_that_lies_on_something_is_named_and_nothing_is_kept() {
    const SEED: u64 = 23;
    let bench = bench(SEED);
    let board = PtyBoard::start(bench.connect);
    let mut hand = Cube::draw(TILT_RAD, SEED).hand(&bench.block, GRAVITY_M_S2);
    let (found, words) = session(&board.port, &["--cube"], &[1], |number| {
        next(&mut hand);
        if number == 4 {
            // 20 mrad about each axis, of which opposite faces show half: ten deviations.
            let [x, y, z] = bench.block.felt();
            bench
                .block
                .put([x + 0.02 * (z - y), y + 0.02 * (x - z), z + 0.02 * (y - x)]);
        }
    });
    let doubt = &found["doubts"][0];
    let named = [&doubt["position"], &doubt["or_position"]];
    assert!(
        named.contains(&&Value::from(4)),
        "seed {SEED}: {found:#} {words}"
    );
    assert_eq!(found["stored"], false);
    assert_eq!(show(&board.port, "4"), None);
}

/// As it is shown to who has no board.
#[test]
fn the_virtual_board_calibrates_itself_on_a_cube() {
    const SEED: u64 = 3;
    let run = |more: &[&str]| {
        let arguments = ["calibrate", "--port", "virtual", "--seed", "3", "--cube"];
        let output = inm(&[&arguments[..], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let found: Value = serde_json::from_str(&run(&["--tilt", "0.5", "--json", "-"])).expect("JSON");
    let truth = Truth::draw(Coefficients::PUBLISHED, SEED);
    let truth = behind(
        Cube::draw(5e-4, SEED).parameters(&truth, SensorRange::G4),
        9,
    );
    for (at, [value, half_width]) in parameters(&found).into_iter().enumerate().take(9) {
        let off = (value - truth[at]).abs() / half_width;
        assert!(
            off < DEVIATIONS,
            "seed {SEED}, {}: {off} half intervals",
            CUBE_NAMES[at]
        );
    }
    assert_eq!(found["tilt_mrad"], 0.5);
    let words = run(&[]);
    assert!(
        words.contains("6 of 18 readings are left to check"),
        "{words}"
    );
    assert!(words.contains("cube's faces"), "{words}");
}
