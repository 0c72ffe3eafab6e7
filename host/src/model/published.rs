//! The published table: the five coefficients of the three axes.
//!
//! A. Pavlov and Petrov, accelerometer channel of an inertial navigation module: MMA7331L read by
//! an ADS1281 at 2000 samples a second for 1.5 h.

use super::PerCoefficient;

/// Data rate of the published experiment, samples a second.
pub const RATE_HZ: f64 = 2000.0;

/// Length of the published record, seconds.
pub const DURATION_S: f64 = 5400.0;

/// The axes of the published module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PublishedAxis {
    /// First horizontal axis.
    X,
    /// Second horizontal axis.
    Y,
    /// Vertical axis.
    Z,
}

impl PublishedAxis {
    /// All three axes.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Name of the axis: its letter.
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "X",
            Self::Y => "Y",
            Self::Z => "Z",
        }
    }

    /// The row of the table, in m/s^2 and seconds.
    pub const fn coefficients(self) -> PerCoefficient<f64> {
        match self {
            Self::X => row(4.2, 3.6, 0.55, 1.05, 2.25),
            Self::Y => row(3.7, 2.3, 0.39, 0.94, 1.82),
            Self::Z => row(5.9, 3.3, 0.48, 1.03, 2.12),
        }
    }
}

/// A row as printed: R in 1e-8 m/s^3, K in 1e-5 m/s^2/sqrt(s), B in 1e-4 m/s^2, N in
/// 1e-4 m/s/sqrt(s), Q in 1e-4 m/s. The accompanying text gives K the order 1e-6; the table,
/// which is followed here, says 1e-5.
const fn row(r: f64, k: f64, b: f64, n: f64, q: f64) -> PerCoefficient<f64> {
    PerCoefficient {
        r: r * 1e-8,
        k: k * 1e-5,
        b: b * 1e-4,
        n: n * 1e-4,
        q: q * 1e-4,
    }
}
