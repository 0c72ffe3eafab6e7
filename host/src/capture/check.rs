//! Whether the numbers of a header can be those of a recording: all that follows is scaled by them.

use std::fmt::{Debug, Display};
use std::ops::RangeInclusive;

use inm_protocol::AXES;

use super::header::Header;
use crate::plain::{PLAIN, is_plain};
use crate::signal::{POSSIBLE_RATE, POSSIBLE_RATE_HZ, SCALE};

/// Ticks of the stamps and cycles of the converters a second: a board has 100 kHz to 168 MHz.
const CLOCK_HZ: RangeInclusive<u32> = 1000..=1_000_000_000;

/// Reference and supply, volts: the parts' own limits are 5.5 V.
const VOLTS: RangeInclusive<f64> = 0.1..=100.0;

/// A field whose value cannot be.
#[derive(Debug, PartialEq)]
pub(super) struct Impossible {
    pub field: String,
    pub found: String,
    pub expected: &'static str,
}

impl Header {
    /// Looks at every number.
    pub(super) fn check(&self) -> Result<(), Impossible> {
        let board = &self.board;
        within("rate_hz", self.rate_hz, &POSSIBLE_RATE_HZ, POSSIBLE_RATE)?;
        for (field, value) in [
            ("board.timer_hz", board.timer_hz),
            ("board.converter_clock_hz", board.converter_clock_hz),
        ] {
            within(field, value, &CLOCK_HZ, "a number from 1000 to 1e9")?;
        }
        for (field, value) in [
            ("board.reference_v", board.reference_v),
            ("board.sensor_supply_v", board.sensor_supply_v),
        ] {
            within(field, value, &VOLTS, "volts from 0.1 to 100")?;
        }
        if self.axes.len() != AXES {
            return Err(impossible("axes", self.axes.len(), "three axes"));
        }
        for (place, axis) in self.axes.iter().enumerate() {
            let field = |name: &str| format!("axes[{place}].{name}");
            let name = &axis.name;
            if !is_plain(name) {
                return Err(impossible(field("name"), name.escape_debug(), PLAIN));
            }
            within(
                field("scale"),
                axis.scale,
                &SCALE,
                "a number from 1e-30 to 1e30",
            )?;
            if !axis.zero.is_finite() {
                return Err(impossible(field("zero"), axis.zero, "a number"));
            }
        }
        Ok(())
    }
}

fn within<T: Copy + PartialOrd + Debug>(
    field: impl Into<String>,
    value: T,
    range: &RangeInclusive<T>,
    expected: &'static str,
) -> Result<(), Impossible> {
    if range.contains(&value) {
        Ok(())
    } else {
        // As short as it can be written: 1e300 has 301 digits.
        Err(impossible(field, format!("{value:?}"), expected))
    }
}

fn impossible(field: impl Into<String>, found: impl Display, expected: &'static str) -> Impossible {
    Impossible {
        field: field.into(),
        found: found.to_string(),
        expected,
    }
}
