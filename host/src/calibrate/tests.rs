//! The fit and its checks on positions drawn from a truth. Seeds are printed by what fails.

use nalgebra::{Matrix3, Vector3};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::{Fit, PARAMETERS, Position, Stretch, Unfit, Unsteady, alike_deg, doubts, fit};
use crate::model::Seed;
use crate::model::random::random;

const GRAVITY_M_S2: f64 = 9.81;

/// A matrix and zeros within the sheets.
const TRUTH: [f64; PARAMETERS] = [0.97, 0.012, 1.04, -0.02, 0.008, 1.03, 1.7, -2.1, 0.6];

/// Standard deviation of a mean, m/s^2.
const NOISE_M_S2: f64 = 1e-4;

fn normal(random: &mut Pcg64) -> f64 {
    StandardNormal.sample(random)
}

/// Readings in random directions, whose felt magnitude is gravity times `pushed`.
fn positions(number: usize, seed: u64, noise: f64, pushed: impl Fn(usize) -> f64) -> Vec<Position> {
    let mut random = random(Seed { seed, stream: 0 });
    let [xx, yx, yy, zx, zy, zz, x, y, z] = TRUTH;
    let matrix = Matrix3::new(xx, 0.0, 0.0, yx, yy, 0.0, zx, zy, zz);
    let inverse = matrix.try_inverse().expect("far from singular");
    let drawn = (0..number).map(|at| {
        let direction = Vector3::from([(); 3].map(|()| normal(&mut random))).normalize();
        let felt = GRAVITY_M_S2 * pushed(at) * direction;
        let reading = inverse * felt + Vector3::new(x, y, z);
        Position {
            mean_m_s2: [0, 1, 2].map(|axis| reading[axis] + noise * normal(&mut random)),
            variance: [noise.max(1e-9).powi(2); 3],
            time_s: 10.0 * at as f64,
        }
    });
    drawn.collect()
}

#[track_caller]
fn fitted(positions: &[Position], seed: u64) -> Fit {
    let end_s = 10.0 * positions.len() as f64;
    fit(positions, GRAVITY_M_S2, end_s).unwrap_or_else(|error| panic!("seed {seed}: {error}"))
}

#[test]
fn without_noise_the_truth_is_found_to_rounding() {
    for seed in 1..=20 {
        let found = fitted(&positions(14, seed, 0.0, |_| 1.0), seed);
        for (value, truth) in found.values.iter().zip(TRUTH) {
            assert!(
                (value - truth).abs() < 1e-9,
                "seed {seed}: {value}, {truth}"
            );
        }
    }
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    const RUNS: u64 = 400;
    let mut inside = [0_u32; PARAMETERS];
    let mut doubted = 0;
    for seed in 1..=RUNS {
        let found = fitted(&positions(18, seed, NOISE_M_S2, |_| 1.0), seed);
        for (at, inside) in inside.iter_mut().enumerate() {
            *inside += u32::from((found.values[at] - TRUTH[at]).abs() <= found.half_widths[at]);
        }
        doubted += u64::from(!doubts(&found).is_empty());
    }
    // Without any wander the strength found for it is never below none, so that the intervals hold a
    // little more than they say: four standard errors downwards, all upwards.
    let least = 0.95 - 4.0 * (0.95 * 0.05 / RUNS as f64).sqrt();
    for (at, inside) in inside.into_iter().enumerate() {
        let share = f64::from(inside) / RUNS as f64;
        assert!(
            share > least,
            "seeds 1 to {RUNS}: parameter {at} inside in {share}"
        );
    }
    // One session in a hundred may be doubted: five standard errors above.
    let most = 0.01 * RUNS as f64 + 5.0 * (0.01 * RUNS as f64).sqrt();
    assert!(
        (doubted as f64) < most,
        "seeds 1 to {RUNS}: {doubted} doubted"
    );
}

#[test]
fn a_position_that_is_not_gravity_is_doubted_by_its_number() {
    const RUNS: u64 = 50;
    let mut found = 0;
    for seed in 1..=RUNS {
        let wrong = (seed % 18) as usize;
        // Some thirty deviations of a mean.
        let pushed = |at: usize| if at == wrong { 1.0003 } else { 1.0 };
        let fit = fitted(&positions(18, seed, NOISE_M_S2, pushed), seed);
        found += u64::from(
            doubts(&fit)
                .first()
                .is_some_and(|doubt| doubt.position == wrong + 1),
        );
    }
    // Random directions leave some positions without others near them, of which nothing shows.
    assert!(found >= RUNS * 8 / 10, "seeds 1 to {RUNS}: {found} found");
}

#[test]
fn too_few_positions_and_positions_about_one_axis_are_refused() {
    let few = positions(11, 1, NOISE_M_S2, |_| 1.0);
    let refused = fit(&few, GRAVITY_M_S2, 110.0).map(|_| ());
    assert_eq!(refused, Err(Unfit::Few { have: 11 }));
    let mut flat = positions(18, 2, NOISE_M_S2, |_| 1.0);
    for (at, position) in flat.iter_mut().enumerate() {
        let (sine, cosine) = (0.35 * at as f64).sin_cos();
        position.mean_m_s2 = [GRAVITY_M_S2 * cosine, GRAVITY_M_S2 * sine, 0.0];
    }
    let refused = fit(&flat, GRAVITY_M_S2, 180.0).map(|_| ());
    assert_eq!(refused, Err(Unfit::Alike), "seed 2");
}

#[test]
fn a_position_that_was_there_is_recognised() {
    let before = positions(6, 3, 0.0, |_| 1.0);
    assert!(alike_deg(&before[..5], &before[5]).is_none(), "seed 3");
    let (which, angle) = alike_deg(&before, &before[3]).expect("the same");
    assert_eq!(which, 4);
    assert!(angle < 1e-4, "{angle}");
    assert_eq!(alike_deg(&[], &before[0]), None);
}

/// Blocks of white noise, with so much added from some block on.
fn stretch(seed: u64, noise: f64, step: impl Fn(usize) -> f64) -> Stretch {
    let mut random = random(Seed { seed, stream: 1 });
    let blocks = (0..500).map(|at| {
        let [x, y, z] = [(); 3].map(|()| noise * normal(&mut random));
        [x, y + step(at), z + GRAVITY_M_S2]
    });
    Stretch {
        blocks: blocks.collect(),
        time_s: 2.5,
    }
}

#[test]
fn a_block_that_moves_or_shakes_does_not_count_and_one_at_rest_does() {
    let rest = stretch(1, 1e-3, |_| 0.0);
    let quiet = rest.scatter();
    assert!(rest.position(Some(quiet)).is_ok(), "seed 1");
    let mut missed = Vec::new();
    for seed in 2..=200 {
        let rest = stretch(seed, 1e-3, |_| 0.0);
        assert!(rest.position(Some(quiet)).is_ok(), "seed {seed}");
        // A tilt by a twentieth of a degree, somewhere in the middle.
        let moved = stretch(seed, 1e-3, |at| {
            if at > 150 + seed as usize { 0.009 } else { 0.0 }
        });
        match moved.position(Some(quiet)) {
            Err(Unsteady::Moved { axis, .. }) => assert_eq!(axis, 'Y', "seed {seed}"),
            _ => missed.push(seed),
        }
    }
    // The deviation that a move is compared with comes from seven squares: by chance it is large. Of 60 000 such
    // moves, drawn elsewhere, 1.06 % passed for that: 2.1 of these, and five deviations of their number.
    assert!(missed.len() <= 9, "seeds {missed:?} missed");
    let shaken = stretch(201, 5e-3, |_| 0.0).position(Some(quiet));
    assert!(
        matches!(shaken, Err(Unsteady::Shaken { .. })),
        "seed 201: {shaken:?}"
    );
    let mut short = rest;
    short.blocks.truncate(99);
    assert_eq!(short.position(None), Err(Unsteady::Short { blocks: 99 }));
}

/// White and differenced noise, of which a plain mean would have several times the variance.
#[test]
fn the_variance_of_a_mean_is_what_means_scatter_by() {
    const RUNS: u64 = 400;
    let (mut stated, mut squares) = (0.0, 0.0);
    for seed in 1..=RUNS {
        let mut random = random(Seed { seed, stream: 2 });
        let mut last = normal(&mut random);
        let blocks = (0..500).map(|_| {
            let velocity = normal(&mut random);
            let differenced = 2e-2 * (velocity - std::mem::replace(&mut last, velocity));
            [differenced + 1e-3 * normal(&mut random), 0.0, 0.0]
        });
        let stretch = Stretch {
            blocks: blocks.collect(),
            time_s: 2.5,
        };
        let position = stretch.position(None).expect("at rest");
        stated += position.variance[0];
        squares += position.mean_m_s2[0].powi(2);
    }
    // A mean of 400 variances with three and one degrees of freedom: 4 and 7 % each; the parts have a
    // remainder of the differenced noise that the whole has not, a tenth at most here.
    let ratio = stated / squares;
    assert!((0.65..1.45).contains(&ratio), "seeds 1 to {RUNS}: {ratio}");
}
