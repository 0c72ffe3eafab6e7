//! What a record is a record of: rate, axes, units, signal chain.

use std::ops::RangeInclusive;

use crate::chain::Chain;

/// Rates that a record or a model may have, samples a second: from one a day to a billion. Sensors of
/// motion have 10 to 100 000; what is far outside is a wrong field, and overflows in squares.
pub const POSSIBLE_RATE_HZ: RangeInclusive<f64> = 1e-5..=1e9;

/// [`POSSIBLE_RATE_HZ`] in words.
pub const POSSIBLE_RATE: &str = "a number from 1e-5 to 1e9";

/// Units a count, without the sign: the board's are 3.7e-8 m/s^2, a count of 1 in any unit that there
/// is lies inside, and their squares do not overflow.
pub const SCALE: RangeInclusive<f64> = 1e-30..=1e30;

/// Largest number that a sample may be, in the unit of its file: far beyond any quantity, and its
/// square, summed over any record and scaled by [`SCALE`], still a number.
pub const LARGEST: f64 = 1e100;

/// What the largest sample of an axis is at least, in the unit of its file, unless all are 0: smaller
/// ones have squares that, scaled by [`SCALE`], come to nothing.
pub const SMALLEST: f64 = 1e-100;

/// Description of a record, known before its first sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// File name, port or the like, for people.
    pub name: String,
    /// Samples a second.
    pub rate_hz: f64,
    /// The axes, in the order of the columns.
    pub axes: Vec<Axis>,
    /// Wall clock at the first sample, RFC 3339, where known.
    pub start: Option<String>,
}

/// One axis of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// `X`, or the column's name or number.
    pub name: String,
    /// Unit of the scaled signal.
    pub unit: Unit,
    /// Units per count: `value = scale * (code - zero)`.
    pub scale: f64,
    /// Code of zero signal, counts.
    pub zero: f64,
    /// What lies between the quantity and the samples, where known.
    pub chain: Option<Chain>,
}

/// Units that a record can be in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Unit {
    /// Metre per second squared.
    #[default]
    #[serde(rename = "m/s^2")]
    MetrePerSecondSquared,
    /// Standard gravity, 9.80665 m/s^2.
    #[serde(rename = "g")]
    Gravity,
    /// Radian per second.
    #[serde(rename = "rad/s")]
    RadianPerSecond,
    /// Degree per second.
    #[serde(rename = "deg/s")]
    DegreePerSecond,
    /// Volts.
    #[serde(rename = "V")]
    Volt,
    /// Converter counts.
    #[serde(rename = "counts")]
    Counts,
}

impl Unit {
    /// All units.
    pub const ALL: [Self; 6] = [
        Self::MetrePerSecondSquared,
        Self::Gravity,
        Self::RadianPerSecond,
        Self::DegreePerSecond,
        Self::Volt,
        Self::Counts,
    ];

    /// As it is written on the command line and in JSON.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::MetrePerSecondSquared => "m/s^2",
            Self::Gravity => "g",
            Self::RadianPerSecond => "rad/s",
            Self::DegreePerSecond => "deg/s",
            Self::Volt => "V",
            Self::Counts => "counts",
        }
    }
}

/// What a unit is one of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Acceleration, in m/s^2.
    Acceleration,
    /// Rate of rotation, in rad/s.
    Rotation,
}

impl Unit {
    /// What it measures, and how many SI units it is; `None` for what is not converted to a
    /// quantity of motion yet.
    pub fn si(self) -> Option<(Dimension, f64)> {
        match self {
            Self::MetrePerSecondSquared => Some((Dimension::Acceleration, 1.0)),
            Self::Gravity => Some((Dimension::Acceleration, 9.806_65)),
            Self::RadianPerSecond => Some((Dimension::Rotation, 1.0)),
            Self::DegreePerSecond => Some((Dimension::Rotation, std::f64::consts::PI / 180.0)),
            Self::Volt | Self::Counts => None,
        }
    }
}

impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.symbol())
    }
}

impl std::str::FromStr for Unit {
    type Err = UnknownUnit;

    fn from_str(text: &str) -> Result<Self, UnknownUnit> {
        Self::ALL
            .into_iter()
            .find(|unit| unit.symbol() == text)
            .ok_or_else(|| UnknownUnit(text.to_owned()))
    }
}

/// A unit that this program does not know.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown unit `{0}`; one of m/s^2, g, rad/s, deg/s, V, counts")]
pub struct UnknownUnit(pub String);
