//! The fit of six positions on a levelled cube: gravity's direction is known in each, so that what the sensors read is
//! linear in twelve parameters.
//!
//! ```text
//!   reading = zero + M^-1 gravity (face + tilt)          three readings on each of six faces
//! ```
//!
//! `M` has nine numbers, in the frame of the cube's faces. The tilts, by which faces are not where they should be, are
//! noise of the deviation that is stated: common to the three readings of a position and hardly anything along gravity.
//! Eighteen readings less twelve parameters leave six to check: of each sensor the zeros by three pairs of opposite
//! faces are one.

mod derived;
mod face;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use self::derived::{derived, in_the_cube, in_the_sensors};
pub use self::face::Face;
use super::average::{Average, Expected};
use super::doubt::FAMILY_LEVEL;
use super::drift::{Drift, published_walk};
use super::weighted::Solved;
use super::{Doubt, PARAMETERS, Position, Unfit};

/// Parameters: xx, xy, xz, yx, yy, yz, zx, zy, zz of `M`, then the zeros of X, Y, Z.
pub const CUBE_PARAMETERS: usize = 12;

/// Names of the parameters, in their order.
pub const CUBE_NAMES: [&str; CUBE_PARAMETERS] = [
    "xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz", "zero X", "zero Y", "zero Z",
];

/// The frame of the result, in words.
pub const CUBE_FRAME: &str = "x, y and z along the normals of the cube's faces, each the one next to the sensitive axis of X, Y and Z";

/// Positions: one on each face.
pub const FACES: usize = 6;

/// Readings: three on each face.
const READINGS: usize = 3 * FACES;

/// What is left of them to check.
pub const FREEDOM: usize = READINGS - CUBE_PARAMETERS;

/// Readings that are judged: those of three axes on three pairs of faces.
const JUDGED: f64 = 9.0;

/// Times that the equations are solved: the tilts' share of the noise depends on the scales, which are within a
/// tenth of the nominal ones at first and known to a thousandth behind it.
const ROUNDS: usize = 3;

/// What was found on a cube.
#[derive(Debug, Clone)]
pub struct CubeFit {
    /// The parameters, in the order of [`CUBE_NAMES`]: without a unit, zeros in m/s^2.
    pub values: [f64; CUBE_PARAMETERS],
    /// Half the 95 % interval of each.
    pub half_widths: [f64; CUBE_PARAMETERS],
    /// The same in the frame of the sensors, as a board keeps it, in the order of [`super::NAMES`].
    pub kept: [f64; PARAMETERS],
    /// Half the 95 % interval of each.
    pub kept_half_widths: [f64; PARAMETERS],
    /// Wander of the zeros that the intervals count with, m/s^2 per root second.
    pub drift: f64,
    /// Sum of the six squared misfits by the noise, the wander and the stated tilts.
    pub chi_squared: f64,
    /// Chance of a larger one.
    pub p_value: f64,
    /// Pairs of opposite faces that the others do not bear out, the worst first.
    pub doubts: Vec<Doubt>,
}

/// Fits the parameters to a position on each face; faces are off level by `tilt_rad`, a standard deviation in each
/// of two directions. Zeros are means about `end_s`, over as long as a position.
///
/// # Errors
/// [`Unfit`].
pub fn fit_cube(
    on: &[(Face, Position)],
    gravity_m_s2: f64,
    tilt_rad: f64,
    end_s: f64,
) -> Result<CubeFit, Unfit> {
    let missing = |face: &Face| !on.iter().any(|(there, _)| there == face);
    if on.len() != FACES || Face::ALL.iter().any(missing) {
        return Err(Unfit::Faces { have: on.len() });
    }
    let positions: Vec<Position> = on.iter().map(|(_, position)| *position).collect();
    // A tilt in two directions takes half their squares off gravity along the face.
    let felt: Vec<Vector3<f64>> = on
        .iter()
        .map(|(face, _)| gravity_m_s2 * (1.0 - tilt_rad.powi(2)) * face.direction())
        .collect();
    let slopes = slopes(&felt);
    let readings = DVector::from_fn(READINGS, |at, _| positions[at / 3].mean_m_s2[at % 3]);
    let mut parameters = DVector::zeros(CUBE_PARAMETERS);
    for diagonal in [0, 4, 8] {
        parameters[diagonal] = 1.0;
    }
    let average_at = |parameters: &DVector<f64>| {
        let tilts = tilts(on, &sensitivity(parameters), gravity_m_s2, tilt_rad);
        let noise = Drift::of_readings(&positions, &tilts, end_s);
        let misfits = &readings - &slopes * parameters;
        let average = Average::new(&noise, &slopes, &misfits, Expected::Published);
        average
            .map(|average| (average, misfits))
            .ok_or(Unfit::NoFit)
    };
    for _ in 1..ROUNDS {
        parameters += average_at(&parameters)?.0.step();
    }
    let (average, misfits) = average_at(&parameters)?;
    parameters += average.step();
    finish(on, &parameters, &average, &misfits)
}

/// What each reading gains by each parameter: nine sensitivities, row by row, and three zeros.
fn slopes(felt: &[Vector3<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(READINGS, CUBE_PARAMETERS, |row, column| {
        let axis = row % 3;
        if column < 9 {
            f64::from(u8::from(column / 3 == axis)) * felt[row / 3][column % 3]
        } else {
            f64::from(u8::from(column - 9 == axis))
        }
    })
}

/// What the tilts do to the readings, (m/s^2)^2.
fn tilts(
    on: &[(Face, Position)],
    sensitivity: &Matrix3<f64>,
    gravity_m_s2: f64,
    tilt_rad: f64,
) -> DMatrix<f64> {
    let mut tilts = DMatrix::zeros(READINGS, READINGS);
    for (at, (face, _)) in on.iter().enumerate() {
        let direction = face.direction();
        let along = direction * direction.transpose();
        // Across in two directions; along, half the sum of their squares has the deviation tilt^2.
        let felt = tilt_rad.powi(2) * (Matrix3::identity() - along) + tilt_rad.powi(4) * along;
        let block = gravity_m_s2.powi(2) * sensitivity * felt * sensitivity.transpose();
        tilts.view_mut((3 * at, 3 * at), (3, 3)).copy_from(&block);
    }
    tilts
}

/// The inverse of `M`.
fn sensitivity(parameters: &DVector<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| parameters[3 * row + column])
}

/// What is told, at the parameters that were found; `misfits` are those ahead of the last step.
fn finish(
    on: &[(Face, Position)],
    parameters: &DVector<f64>,
    average: &Average,
    misfits: &DVector<f64>,
) -> Result<CubeFit, Unfit> {
    let sensible = |fit: &CubeFit| [0, 2, 5].iter().all(|&diagonal| fit.kept[diagonal] > 0.0);
    let (values, half_widths) = derived(parameters, average, in_the_cube).ok_or(Unfit::NoFit)?;
    let (kept, kept_half_widths) =
        derived(parameters, average, in_the_sensors).ok_or(Unfit::NoFit)?;
    let likeliest = average.likeliest().ok_or(Unfit::NoFit)?;
    let chi_squared = misfits.dot(&(likeliest.projector() * misfits));
    let fit = CubeFit {
        values,
        half_widths,
        kept,
        kept_half_widths,
        drift: average.times() * published_walk(),
        chi_squared,
        p_value: ChiSquared::new(FREEDOM as f64).map_or(f64::NAN, |law| law.sf(chi_squared)),
        doubts: doubts(on, likeliest, misfits),
    };
    Some(fit).filter(sensible).ok_or(Unfit::NoFit)
}

/// Readings that the other faces do not bear out (Baarda's test of one reading, Netherlands Geodetic Commission 2(5),
/// 1968), the worst first. Of two opposite faces only the sum is checked: each pair is judged once for each axis, and all share the
/// level.
fn doubts(on: &[(Face, Position)], solved: &Solved, misfits: &DVector<f64>) -> Vec<Doubt> {
    let Ok(law) = Normal::new(0.0, 1.0) else {
        return Vec::new();
    };
    let projector = solved.projector();
    let weighted = &projector * misfits;
    let mut doubts = Vec::new();
    for (at, (face, _)) in on.iter().enumerate() {
        let opposite = on.iter().position(|(other, _)| *other == face.opposite());
        // Each pair by the one that was there first.
        if opposite.is_none_or(|opposite| opposite < at) {
            continue;
        }
        for axis in 0..3 {
            let reading = 3 * at + axis;
            let left = projector[(reading, reading)];
            let beyond = weighted[reading].abs() / left.sqrt();
            doubts.push(Doubt {
                position: at + 1,
                or_position: opposite.map(|opposite| opposite + 1),
                axis: Some(['X', 'Y', 'Z'][axis]),
                misfit_m_s2: weighted[reading] / left,
                p_value: (2.0 * JUDGED * law.sf(beyond)).min(1.0),
            });
        }
    }
    doubts.retain(|doubt| doubt.p_value < FAMILY_LEVEL);
    doubts.sort_by(|one, other| one.p_value.total_cmp(&other.p_value));
    doubts
}
