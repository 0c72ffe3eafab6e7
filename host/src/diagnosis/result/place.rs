//! Where in frequency, time or amplitude something is wrong.

use std::fmt;
use std::ops::Range;

use serde::ser::{Serialize, SerializeStruct, Serializer};

/// A place, as text says it.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// Between two frequencies, hertz, and where within it is plainest if that is known.
    Band {
        /// Lower and upper end, hertz.
        ends_hz: [f64; 2],
        /// Frequency at which it is plainest, hertz.
        peak_hz: Option<f64>,
    },
    /// At one frequency, hertz.
    Line(f64),
    /// In the power over time, with this period, seconds.
    Period(f64),
    /// In the power over time, slower than this period, seconds.
    Slower(f64),
    /// In a stretch of time, from and to, seconds since the start of the record.
    Stretch([f64; 2]),
    /// Among the largest values.
    UpperSide,
    /// Among the smallest.
    LowerSide,
}

impl From<Range<f64>> for Place {
    /// The place between two frequencies, hertz.
    fn from(band: Range<f64>) -> Self {
        Self::Band {
            ends_hz: [band.start, band.end],
            peak_hz: None,
        }
    }
}

impl Place {
    /// The frequencies between which it is, hertz; `None` where it is no place in frequency.
    pub fn band_hz(&self) -> Option<[f64; 2]> {
        match self {
            Self::Band { ends_hz, .. } => Some(*ends_hz),
            Self::Line(f_hz) => Some([*f_hz; 2]),
            _ => None,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Band {
                ends_hz: [from_hz, to_hz],
                peak_hz,
            } => {
                write!(f, "{from_hz:.5} to {to_hz:.5} Hz")?;
                peak_hz.map_or(Ok(()), |peak_hz| write!(f, ", plainest at {peak_hz:.5} Hz"))
            }
            Self::Line(f_hz) => write!(f, "{f_hz:.5} Hz"),
            Self::Period(period_s) => write!(f, "period {period_s:.4} s"),
            Self::Slower(period_s) => write!(f, "period down to {period_s:.4} s"),
            Self::Stretch([from_s, to_s]) => write!(f, "{from_s:.3} s to {to_s:.3} s"),
            Self::UpperSide => f.write_str("upper side"),
            Self::LowerSide => f.write_str("lower side"),
        }
    }
}

/// `where`, the text, and `band_hz`, the two frequencies or null.
impl Serialize for Place {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Place", 2)?;
        fields.serialize_field("where", &self.to_string())?;
        fields.serialize_field("band_hz", &self.band_hz())?;
        fields.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_told_in_words_and_as_frequencies() {
        let said = |place: &Place| serde_json::to_value(place).expect("JSON");
        let band = Place::Band {
            ends_hz: [18.0, 27.5],
            peak_hz: Some(19.0),
        };
        assert_eq!(
            said(&band),
            serde_json::json!({
                "where": "18.00000 to 27.50000 Hz, plainest at 19.00000 Hz",
                "band_hz": [18.0, 27.5],
            })
        );
        assert_eq!(
            said(&Place::Period(2.0)),
            serde_json::json!({ "where": "period 2.0000 s", "band_hz": null })
        );
    }
}
