//! Scale, misalignment and zero of three accelerometers from how they read gravity at rest in many
//! positions: whatever the position, the magnitude is the same.
//!
//! ```text
//!   blocks of a stretch --> stretch: still? --> Position --+
//!                                                          v
//!   gravity ------------------------------------> magnitude: weighted fit of nine parameters
//!                                                          |   ^
//!                                                          v   | drift, average: how far zeros wander meanwhile
//!                                    doubt: a position that fits no others; too few different ones
//! ```
//!
//! `acceleration = M (reading - zero)`, `M` lower triangular: x is the sensitive axis of X, y lies in the
//! plane of X and Y. Nothing else is known of a frame, since gravity's magnitude is the same in all of
//! them. Zeros are means over as long as a stretch, at the end of the session, after which they are used.
//!
//! On a levelled cube gravity's direction is known too: six positions give all of `M`, in the frame of its faces ([`fit_cube`]).

mod average;
mod change;
mod cube;
mod doubt;
mod drift;
mod found;
mod magnitude;
mod stretch;
mod weighted;

pub use change::Since;
pub use cube::{CUBE_FRAME, CUBE_NAMES, CUBE_PARAMETERS, CubeFit, FACES, FREEDOM, Face, fit_cube};
pub use doubt::{Doubt, alike_deg, doubts};
pub use found::{Circumstances, FRAME, Found};
pub use magnitude::{Fit, Unfit, fit};
pub use stretch::{BLOCK_S, Stretch, Unsteady};

#[cfg(test)]
mod tests;

/// Parameters: xx, yx, yy, zx, zy, zz of `M`, then the zeros of X, Y, Z.
pub const PARAMETERS: usize = 9;

/// Names of the parameters, in their order.
pub const NAMES: [&str; PARAMETERS] = [
    "xx", "yx", "yy", "zx", "zy", "zz", "zero X", "zero Y", "zero Z",
];

/// Fewest positions: three more than there are parameters, so that one that is wrong shows.
pub const FEWEST: usize = 12;

/// What the sensors read in one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// Mean reading by the nominal scale, m/s^2.
    pub mean_m_s2: [f64; 3],
    /// Variance of the mean as the stretch itself shows it, (m/s^2)^2.
    pub variance: [f64; 3],
    /// Its middle, seconds since the session began.
    pub time_s: f64,
}
