//! What the user says about an array file that the file itself cannot: rate, axes, units.

use std::ops::Range;
use std::str::FromStr;

use crate::chain::Chain;
use crate::signal::Unit;

/// How to read an array file. [`Default`] says nothing: every column is an axis in m/s^2.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ArrayOptions {
    /// Samples a second, above zero.
    pub rate_hz: Option<f64>,
    /// Column of time stamps in seconds; they give the rate where none is stated, and the gaps.
    pub time: Option<Selector>,
    /// The axes, in this order; empty means every column that is not the time.
    pub columns: Vec<Selector>,
    /// Unit of the scaled data.
    pub unit: Option<Unit>,
    /// Units per count: empty, one for all axes, or one for each.
    pub scales: Vec<f64>,
    /// Leaves out what lies before this time since the start, seconds.
    pub from_s: Option<f64>,
    /// Leaves out what lies at or after this time since the start, seconds.
    pub to_s: Option<f64>,
    /// Leaves out these stretches, seconds since the start of what is read, each not empty.
    pub exclude_s: Vec<Range<f64>>,
    /// Signal chain that the data came through.
    pub chain: Option<Chain>,
}

/// Names a column: by its number from 0, or by the name in the header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Selector {
    /// Number from 0.
    Number(usize),
    /// Name in the header line of a text file.
    Name(String),
}

impl FromStr for Selector {
    type Err = EmptySelector;

    fn from_str(text: &str) -> Result<Self, EmptySelector> {
        let text = text.trim();
        if text.is_empty() {
            return Err(EmptySelector);
        }
        Ok(text
            .parse()
            .map_or_else(|_| Self::Name(text.to_owned()), Self::Number))
    }
}

impl std::fmt::Display for Selector {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => f.write_str(name),
        }
    }
}

/// A column selector without a number or name in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("empty column name; give a number from 0 or a name from the header")]
pub struct EmptySelector;
