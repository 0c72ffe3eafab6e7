//! What the user says about an array file that the file itself cannot: rate, axes, units.

use std::ops::Range;
use std::str::FromStr;

use crate::chain::Chain;
use crate::signal::Unit;

/// How to read an array file. [`Default`] says nothing: every column is an axis, in the unit that its
/// name says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ArrayOptions {
    /// Samples a second, above zero.
    pub rate_hz: Option<f64>,
    /// Column of time stamps; they give the rate where none is stated, and the gaps.
    pub time: Option<TimeColumn>,
    /// How fractions are written in a text file; `None` where its lines show it.
    pub decimal: Option<Decimal>,
    /// The axes, in this order; empty means every column that is not the time.
    pub columns: Vec<Selector>,
    /// Unit of the scaled data; `None` where the names of the columns say it.
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

/// A column of time stamps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TimeColumn {
    /// Which.
    pub column: Selector,
    /// The unit of its numbers; `None` where its name says it, or for seconds.
    pub unit: Option<TimeUnit>,
}

/// Units of time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds.
    Seconds,
    /// Milliseconds.
    Milliseconds,
    /// Microseconds.
    Microseconds,
    /// Nanoseconds.
    Nanoseconds,
}

impl TimeUnit {
    /// All units.
    pub const ALL: [Self; 4] = [
        Self::Seconds,
        Self::Milliseconds,
        Self::Microseconds,
        Self::Nanoseconds,
    ];

    /// As it is written on the command line.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Seconds => "s",
            Self::Milliseconds => "ms",
            Self::Microseconds => "us",
            Self::Nanoseconds => "ns",
        }
    }

    /// How many make a second.
    pub const fn per_second(self) -> f64 {
        match self {
            Self::Seconds => 1.0,
            Self::Milliseconds => 1e3,
            Self::Microseconds => 1e6,
            Self::Nanoseconds => 1e9,
        }
    }
}

impl FromStr for TimeColumn {
    type Err = EmptySelector;

    /// `COLUMN`, or `COLUMN:UNIT`; a colon before anything else belongs to the name.
    fn from_str(text: &str) -> Result<Self, EmptySelector> {
        let text = text.trim();
        let unit_of = |symbol| TimeUnit::ALL.into_iter().find(|one| one.symbol() == symbol);
        let split = text.rsplit_once(':');
        let split = split.and_then(|(column, symbol)| Some((column, unit_of(symbol)?)));
        let (column, unit) = split.map_or((text, None), |(column, unit)| (column, Some(unit)));
        Ok(Self {
            column: column.parse()?,
            unit,
        })
    }
}

/// How fractions are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decimal {
    /// `0.5`.
    Point,
    /// `0,5`.
    Comma,
}

impl FromStr for Decimal {
    type Err = UnknownDecimal;

    fn from_str(text: &str) -> Result<Self, UnknownDecimal> {
        match text {
            "point" => Ok(Self::Point),
            "comma" => Ok(Self::Comma),
            _ => Err(UnknownDecimal),
        }
    }
}

/// Not a way to write fractions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected point (0.5) or comma (0,5)")]
pub struct UnknownDecimal;

/// A column selector without a number or name in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("empty column name; give a number from 0 or a name from the header")]
pub struct EmptySelector;
