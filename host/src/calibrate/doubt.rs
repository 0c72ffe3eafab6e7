//! What speaks against a calibration: a position that the others do not bear out, and positions that are
//! one and the same.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::{Fit, Position};

/// Chance that any position of a sound session is doubted.
pub(super) const FAMILY_LEVEL: f64 = 0.01;

/// Positions closer than this are one and the same, degrees: of 24 spread evenly neighbours are 40 apart.
const ALIKE_DEG: f64 = 10.0;

/// Why a calibration should not be used as it is.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Doubt {
    /// The position, from 1.
    pub position: usize,
    /// On a cube the one on the opposite face, from 1: which of the two it is does not show. `None` elsewhere.
    pub or_position: Option<usize>,
    /// On a cube the axis whose reading is not borne out: X, Y or Z. `None` elsewhere.
    pub axis: Option<char>,
    /// Its magnitude (on a cube the reading of that axis) less what the others say, m/s^2.
    pub misfit_m_s2: f64,
    /// Chance of a misfit as large among all positions of a sound session.
    pub p_value: f64,
}

/// Positions whose magnitude the others do not bear out, the worst first: one that was not at rest, or
/// with something that pushed. All positions share the level.
pub fn doubts(fit: &Fit) -> Vec<Doubt> {
    let Ok(law) = StudentsT::new(0.0, 1.0, fit.freedom) else {
        return Vec::new();
    };
    let number = fit.studentised.len() as f64;
    let judged = fit.studentised.iter().zip(&fit.misfits_m_s2).enumerate();
    let mut doubts: Vec<Doubt> = judged
        .map(|(at, (studentised, misfit))| Doubt {
            position: at + 1,
            or_position: None,
            axis: None,
            misfit_m_s2: -misfit,
            p_value: (2.0 * number * law.sf(studentised.abs())).min(1.0),
        })
        .filter(|doubt| doubt.p_value < FAMILY_LEVEL)
        .collect();
    doubts.sort_by(|one, other| one.p_value.total_cmp(&other.p_value));
    doubts
}

/// The position among those before, from 1, that this one only repeats; the angle between them, degrees.
pub fn alike_deg(before: &[Position], new: &Position) -> Option<(usize, f64)> {
    let angles = before.iter().map(|old| angle_deg(old, new));
    let (at, angle) = angles
        .enumerate()
        .min_by(|one, other| one.1.total_cmp(&other.1))?;
    (angle < ALIKE_DEG).then_some((at + 1, angle))
}

fn angle_deg(one: &Position, other: &Position) -> f64 {
    let [one, other] = [one, other].map(|position| nalgebra::Vector3::from(position.mean_m_s2));
    one.angle(&other).to_degrees()
}
