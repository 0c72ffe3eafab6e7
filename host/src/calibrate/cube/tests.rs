//! The fit on a cube, on readings drawn from a truth. Seeds are printed by what fails.

use nalgebra::{Matrix3, Vector3};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::*;
use crate::model::Seed;
use crate::model::random::random;

const GRAVITY_M_S2: f64 = 9.81;

/// Sensitivities in the cube's frame and zeros within the sheets.
const SENSITIVITY: [[f64; 3]; 3] = [
    [1.03, 0.02, -0.01],
    [0.015, 0.96, 0.03],
    [-0.02, 0.01, 1.02],
];
const ZEROS: [f64; 3] = [1.9, -2.2, 0.7];

/// Standard deviation of a mean, m/s^2: what zeros wander in a minute, hardly more, is that of the published sensors.
const NOISE_M_S2: f64 = 3e-3;

/// What a thing is tilted by, rad.
const TILT_RAD: f64 = 1e-3;

fn normal(random: &mut Pcg64) -> f64 {
    StandardNormal.sample(random)
}

/// Truth in the order of the parameters.
fn truth() -> [f64; CUBE_PARAMETERS] {
    let matrix = Matrix3::from(SENSITIVITY).transpose();
    let inverse = matrix.try_inverse().expect("far from singular");
    std::array::from_fn(|at| match at.checked_sub(9) {
        None => inverse[(at / 3, at % 3)],
        Some(axis) => ZEROS[axis],
    })
}

/// Readings on all faces with this noise and tilt, each face a little further off as `wrong` says, rad.
fn on(seed: u64, noise: f64, tilt: f64, wrong: impl Fn(usize) -> f64) -> Vec<(Face, Position)> {
    let mut random = random(Seed { seed, stream: 5 });
    let matrix = Matrix3::from(SENSITIVITY).transpose();
    let drawn = Face::ALL.into_iter().enumerate().map(|(at, face)| {
        let mut up = face.direction();
        for axis in 0..3 {
            if face.direction()[axis] == 0.0 {
                up[axis] = tilt * normal(&mut random) + wrong(at);
            }
        }
        let reading = matrix * (GRAVITY_M_S2 * up.normalize()) + Vector3::from(ZEROS);
        let position = Position {
            mean_m_s2: [0, 1, 2].map(|axis| reading[axis] + noise * normal(&mut random)),
            variance: [noise.max(1e-9).powi(2); 3],
            time_s: 10.0 * at as f64,
        };
        (face, position)
    });
    drawn.collect()
}

#[track_caller]
fn fitted(on: &[(Face, Position)], seed: u64) -> CubeFit {
    fit_cube(on, GRAVITY_M_S2, TILT_RAD, 60.0)
        .unwrap_or_else(|error| panic!("seed {seed}: {error}"))
}

#[test]
fn without_noise_and_tilt_the_truth_is_found_but_for_what_tilts_take_on_average() {
    let found = fitted(&on(1, 0.0, 0.0, |_| 0.0), 1);
    for (at, (value, truth)) in found.values.iter().zip(truth()).enumerate() {
        // Gravity along a face is taken to be less by what tilts take on average, half the sum of two squares.
        let expected = truth * if at < 9 { 1.0 - TILT_RAD.powi(2) } else { 1.0 };
        assert!(
            (value - expected).abs() < 1e-9,
            "parameter {at}: {value}, {expected}"
        );
    }
    // What the board keeps gives the same magnitudes.
    let kept = |reading: Vector3<f64>| {
        let [xx, yx, yy, zx, zy, zz, x, y, z] = found.kept;
        Matrix3::new(xx, 0.0, 0.0, yx, yy, 0.0, zx, zy, zz) * (reading - Vector3::new(x, y, z))
    };
    for (_, position) in on(1, 0.0, 0.0, |_| 0.0) {
        let magnitude = kept(position.mean_m_s2.into()).norm();
        let expected = GRAVITY_M_S2 * (1.0 - TILT_RAD.powi(2));
        assert!((magnitude - expected).abs() < 1e-8, "{magnitude}");
    }
    assert!(found.chi_squared < 1e-9, "{}", found.chi_squared);
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say_and_misfits_are_as_large_as_expected() {
    const RUNS: u64 = 400;
    let mut inside = [0_u32; CUBE_PARAMETERS];
    let (mut doubted, mut squares) = (0_u32, 0.0);
    for seed in 1..=RUNS {
        let found = fitted(&on(seed, NOISE_M_S2, TILT_RAD, |_| 0.0), seed);
        for (at, truth) in truth().into_iter().enumerate() {
            inside[at] += u32::from((found.values[at] - truth).abs() <= found.half_widths[at]);
        }
        doubted += u32::from(!found.doubts.is_empty());
        squares += found.chi_squared;
    }
    let runs = RUNS as f64;
    // Four standard errors of a share for each of twelve; the noise is so much larger than the wander, which is not there, that
    // this makes no interval wider by more than a hundredth.
    let error = 4.0 * (0.95 * 0.05 / runs).sqrt();
    for (name, inside) in CUBE_NAMES.iter().zip(inside) {
        let share = f64::from(inside) / runs;
        assert!(
            (share - 0.95).abs() < error,
            "seeds 1 to {RUNS}: {name} inside in {share}"
        );
    }
    let most = FAMILY_LEVEL * runs + 5.0 * (FAMILY_LEVEL * runs).sqrt();
    assert!(
        f64::from(doubted) < most,
        "seeds 1 to {RUNS}: {doubted} doubted"
    );
    // Six degrees of freedom: the mean of so many has the deviation sqrt(12 / runs).
    let off = squares / runs - FREEDOM as f64;
    assert!(
        off.abs() < 5.0 * (12.0 / runs).sqrt(),
        "seeds 1 to {RUNS}: {off}"
    );
}

#[test]
fn a_face_that_lies_on_something_is_named_with_the_one_opposite() {
    for seed in 1..=50 {
        let wrong = (seed % 6) as usize;
        // Thirty deviations of a tilt, of which the pair shows half.
        let found = fitted(
            &on(
                seed,
                1e-4,
                TILT_RAD,
                |at| if at == wrong { 0.03 } else { 0.0 },
            ),
            seed,
        );
        let first = found
            .doubts
            .first()
            .unwrap_or_else(|| panic!("seed {seed}: no doubt"));
        let named = [first.position, first.or_position.expect("on a cube")];
        assert!(named.contains(&(wrong + 1)), "seed {seed}: {first:?}");
        assert_eq!(
            named[0].abs_diff(named[1]),
            1,
            "seed {seed}: opposite ones follow each other"
        );
    }
}

/// A parallelogram: what is off on one face is off the other way on the opposite one.
#[test]
fn a_cube_that_is_not_square_is_misalignment_and_no_doubt() {
    const ASKEW_RAD: f64 = 0.01;
    let askew = |at: usize| {
        if at.is_multiple_of(2) {
            ASKEW_RAD
        } else {
            -ASKEW_RAD
        }
    };
    let square = fitted(&on(3, 0.0, 0.0, |_| 0.0), 3);
    let found = fitted(&on(3, 0.0, 0.0, askew), 3);
    assert_eq!(found.doubts, [], "{}", found.chi_squared);
    for (at, (one, other)) in square.values.iter().zip(found.values).enumerate() {
        let off = (one - other).abs();
        let diagonal = [0, 4, 8].contains(&at);
        // To the second order of the angle, and the sensors' own misalignment times it.
        let near = |expected: f64| (off - expected).abs() < 2e-3;
        match at {
            _ if diagonal => assert!(near(0.0), "{at}: {off}"),
            0..9 => assert!(near(ASKEW_RAD), "{at}: {off}"),
            _ => assert!(off < 1e-9, "{at}: {off}"),
        }
    }
}

#[test]
fn a_face_is_known_by_its_readings_whatever_the_sheets_allow() {
    for (at, (face, mut position)) in on(7, 0.0, 0.0, |_| 0.0).into_iter().enumerate() {
        assert_eq!(Face::of(&position), Ok(face), "{at}");
        assert_eq!(face.opposite().opposite(), face);
        // On an edge.
        let [x, y, z] = position.mean_m_s2;
        let turned = std::f64::consts::FRAC_1_SQRT_2;
        position.mean_m_s2 = match at / 2 {
            0 => [x + turned * z, y, turned * z],
            _ => [turned * (x + y), turned * (y - x), z],
        };
        let refused = Face::of(&position).expect_err("an edge");
        assert!(
            refused.to_string().contains("no face of the cube is up"),
            "{refused}"
        );
    }
}

#[test]
fn six_positions_that_are_not_six_faces_are_refused() {
    let all = on(8, 0.0, 0.0, |_| 0.0);
    let refused = fit_cube(&all[..5], GRAVITY_M_S2, TILT_RAD, 60.0).map(|_| ());
    assert_eq!(refused, Err(Unfit::Faces { have: 5 }));
    let mut twice = all;
    twice[5] = twice[4];
    let refused = fit_cube(&twice, GRAVITY_M_S2, TILT_RAD, 60.0).map(|_| ());
    assert_eq!(refused, Err(Unfit::Faces { have: 6 }));
}
