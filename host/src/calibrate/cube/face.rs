//! Which face of the cube is up, as the readings themselves say.

use nalgebra::Vector3;

use super::super::Position;
use super::FACES;

/// Largest reading across over the one along gravity that a face has: by the sheets (zeros of a quarter of a g, scales of 6 %,
/// axes of two degrees) 0.43 at most; on an edge it is 1, between 0.45 and the inverse of that with such zeros.
const ACROSS: f64 = 0.45;

/// A face of the cube: the axis of the sensors that is next to its normal, and whether that reads gravity (up) or less
/// gravity (down).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Face {
    /// X, Y, Z: 0, 1, 2.
    axis: usize,
    up: bool,
}

/// A position on none of the faces.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "no face of the cube is up: {along} reads {along_m_s2:+.1} m/s^2 and {across} {across_m_s2:+.1}"
)]
pub struct NoFace {
    /// The axis that reads most.
    pub along: char,
    /// What it reads, m/s^2.
    pub along_m_s2: f64,
    /// The axis that reads most of the other two.
    pub across: char,
    /// What it reads, m/s^2.
    pub across_m_s2: f64,
}

impl Face {
    /// All six, opposite ones behind each other.
    pub const ALL: [Self; FACES] = [
        Self { axis: 2, up: true },
        Self { axis: 2, up: false },
        Self { axis: 0, up: true },
        Self { axis: 0, up: false },
        Self { axis: 1, up: true },
        Self { axis: 1, up: false },
    ];

    /// The face that is up in a position.
    ///
    /// # Errors
    /// [`NoFace`] where none is.
    pub fn of(position: &Position) -> Result<Self, NoFace> {
        let mut order = [0, 1, 2];
        let reads = |axis: usize| position.mean_m_s2[axis];
        order.sort_by(|&one, &other| reads(other).abs().total_cmp(&reads(one).abs()));
        let [along, across, _] = order;
        if reads(across).abs() > ACROSS * reads(along).abs() {
            return Err(NoFace {
                along: NAMES[along],
                along_m_s2: reads(along),
                across: NAMES[across],
                across_m_s2: reads(across),
            });
        }
        Ok(Self {
            axis: along,
            up: reads(along) > 0.0,
        })
    }

    /// The one below while this one is up.
    #[must_use]
    pub fn opposite(self) -> Self {
        Self {
            up: !self.up,
            ..self
        }
    }

    /// Gravity in the cube's frame while it is up, in units of gravity.
    pub fn direction(self) -> Vector3<f64> {
        let mut direction = Vector3::zeros();
        direction[self.axis] = if self.up { 1.0 } else { -1.0 };
        direction
    }
}

/// Names of the axes.
const NAMES: [char; 3] = ['X', 'Y', 'Z'];

impl std::fmt::Display for Face {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let way = if self.up { "up" } else { "down" };
        write!(f, "{} {way}", NAMES[self.axis])
    }
}
