//! What was found of the accelerometers by turning the board: kept on the board, carried in captures.

use serde::{Deserialize, Serialize};

use crate::{AXES, SensorRange};

/// Numbers of the lower triangle of a matrix of three rows.
pub const TRIANGLE: usize = 6;

/// Scale, misalignment and zero of the accelerometers on one range: `acceleration = rows * (codes - zero)`.
///
/// The frame is that of the sensors: x is the sensitive axis of X, y lies in the plane of those of X
/// and Y, so that above the diagonal all is zero. Integers, so that a record is equal or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct SensorCalibration {
    /// Range that it was found on.
    pub range: SensorRange,
    /// When it was found, by the host's clock: seconds since 1970-01-01 UTC.
    pub unix_s: i64,
    /// Temperature of the microcontroller by then, 0.01 degC; `None` where it was not measured.
    pub centi_celsius: Option<i16>,
    /// Local gravity that it counts by, micrometres per second squared.
    pub gravity_um_s2: u32,
    /// Positions that it was found from.
    pub positions: u16,
    /// xx, yx, yy, zx, zy, zz of the lower triangle, 1e-16 m/s^2 per count of the code: some 3.7e8 of
    /// them on the 4 g range, 1.4e9 on the 12 g range.
    pub rows: [i32; TRIANGLE],
    /// Standard deviations of `rows`, in their unit.
    pub row_deviations: [u32; TRIANGLE],
    /// Codes of X, Y, Z without acceleration, counts.
    pub zero: [i32; AXES],
    /// Standard deviations of `zero`, counts.
    pub zero_deviations: [u32; AXES],
}

impl SensorCalibration {
    /// Unit of `rows`, m/s^2 per count.
    pub const ROW_UNIT: f64 = 1e-16;

    /// Where in `rows` the diagonal of X, Y, Z stands.
    pub const DIAGONAL: [usize; AXES] = [0, 2, 5];

    /// Whether it may be used at all: gravity and the scale of each axis are above zero.
    pub fn is_sound(&self) -> bool {
        let scales = Self::DIAGONAL.map(|at| self.rows.get(at).copied().unwrap_or(0));
        self.gravity_um_s2 > 0 && scales.iter().all(|&scale| scale > 0)
    }
}
