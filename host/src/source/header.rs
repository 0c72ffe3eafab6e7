//! What a column's name says of its unit: `ax_g`, `accel_x (m/s^2)`, `t [ms]`, `millis`.

use super::options::TimeUnit;
use crate::signal::Unit;

/// Spellings of units, each with how many of `Unit` it is. Lower case, without blanks; a V is a volt.
const UNITS: [(&[&str], Unit, f64); 14] = [
    (
        &[
            "m/s^2", "m/s2", "m/s/s", "m/sec^2", "ms^-2", "m.s^-2", "m*s^-2", "mps2", "mps^2",
            "mss", "m_s2", "m_s_2", "m_per_s2",
        ],
        Unit::MetrePerSecondSquared,
        1.0,
    ),
    (
        &["cm/s^2", "cm/s2", "gal"],
        Unit::MetrePerSecondSquared,
        1e-2,
    ),
    (&["mm/s^2", "mm/s2"], Unit::MetrePerSecondSquared, 1e-3),
    (&["g", "gs", "gn", "g0"], Unit::Gravity, 1.0),
    (&["mg"], Unit::Gravity, 1e-3),
    (&["ug"], Unit::Gravity, 1e-6),
    (
        &["rad/s", "rad/sec", "rads", "radps", "rad_s", "rad_per_s"],
        Unit::RadianPerSecond,
        1.0,
    ),
    (&["mrad/s", "mrads"], Unit::RadianPerSecond, 1e-3),
    (
        &[
            "deg/s",
            "deg/sec",
            "°/s",
            "dps",
            "degps",
            "degrees/s",
            "deg_s",
            "deg_per_s",
        ],
        Unit::DegreePerSecond,
        1.0,
    ),
    (&["mdps", "mdeg/s"], Unit::DegreePerSecond, 1e-3),
    (
        &["deg/h", "deg/hr", "°/h"],
        Unit::DegreePerSecond,
        1.0 / 3600.0,
    ),
    (&["V", "volt", "volts"], Unit::Volt, 1.0),
    (&["mV"], Unit::Volt, 1e-3),
    (
        &["counts", "count", "lsb", "lsbs", "digits"],
        Unit::Counts,
        1.0,
    ),
];

/// Spellings of units of time.
const TIMES: [(&[&str], TimeUnit); 4] = [
    (
        &["s", "sec", "secs", "second", "seconds"],
        TimeUnit::Seconds,
    ),
    (
        &[
            "ms",
            "msec",
            "milli",
            "millis",
            "millisecond",
            "milliseconds",
        ],
        TimeUnit::Milliseconds,
    ),
    (
        &[
            "us",
            "usec",
            "micro",
            "micros",
            "microsecond",
            "microseconds",
        ],
        TimeUnit::Microseconds,
    ),
    (
        // The last two are what `rostopic echo -p` calls its stamps, which are nanoseconds.
        &[
            "ns",
            "nsec",
            "nano",
            "nanos",
            "nanosecond",
            "nanoseconds",
            "%time",
            "field.header.stamp",
        ],
        TimeUnit::Nanoseconds,
    ),
];

/// Names of a time whose unit they do not say.
const TIME_NAMES: [&str; 10] = [
    "t",
    "time",
    "times",
    "timestamp",
    "time_stamp",
    "stamp",
    "elapsed",
    "clock",
    "epoch",
    "datetime",
];

/// A name without the unit that stands behind it in brackets, and what stands there.
fn parts(name: &str) -> (&str, Option<&str>) {
    let bracketed = name.trim_end().strip_suffix([')', ']', '}']);
    bracketed
        .and_then(|rest| rest.rsplit_once(['(', '[', '{']))
        .map_or((name.trim(), None), |(bare, unit)| {
            (bare.trim(), Some(unit.trim()))
        })
}

/// As [`UNITS`] spells them.
fn spelt(unit: &str) -> String {
    let unit = unit
        .replace(['²'], "^2")
        .replace("**", "^")
        .replace(['µ', 'μ'], "u");
    let unit: String = unit.chars().filter(|one| !one.is_whitespace()).collect();
    match unit.as_str() {
        "V" | "mV" => unit,
        _ => unit.to_lowercase(),
    }
}

/// The last words of a name with `_` between them, the longest part first.
fn endings(name: &str) -> impl Iterator<Item = &str> {
    name.match_indices('_').map(|(at, _)| &name[at + 1..])
}

/// The unit that `text` spells, and how many of it one is.
fn unit_of(text: &str) -> Option<(Unit, f64)> {
    let text = spelt(text);
    let known = |(spellings, _, _): &&(&[&str], Unit, f64)| spellings.contains(&text.as_str());
    UNITS
        .iter()
        .find(known)
        .map(|&(_, unit, worth)| (unit, worth))
}

/// The unit that the name of an axis says, and how many of it a number is worth.
pub fn unit(name: &str) -> Option<(Unit, f64)> {
    // A magnetometer's g is a gauss.
    let is_magnetic = name.to_lowercase().contains("mag");
    match parts(name) {
        (_, Some(unit)) => unit_of(unit),
        (bare, None) => endings(bare).find_map(unit_of),
    }
    .filter(|(unit, _)| !(is_magnetic && *unit == Unit::Gravity))
}

fn time_of(text: &str) -> Option<TimeUnit> {
    let text = spelt(text);
    let known = |(spellings, _): &&(&[&str], TimeUnit)| spellings.contains(&text.as_str());
    TIMES.iter().find(known).map(|&(_, unit)| unit)
}

/// The unit that the name of a column of stamps says.
pub fn time_unit(name: &str) -> Option<TimeUnit> {
    match parts(name) {
        (_, Some(unit)) => time_of(unit),
        (bare, None) => time_of(bare).or_else(|| endings(bare).find_map(time_of)),
    }
}

/// Whether a name is that of a time.
pub fn is_time(name: &str) -> bool {
    let (bare, unit) = parts(name);
    let lower = bare.to_lowercase();
    let first = lower
        .split_once('_')
        .map_or(lower.as_str(), |(first, _)| first);
    TIME_NAMES.contains(&lower.as_str())
        || time_of(bare).is_some_and(|_| bare.len() > 1)
        || unit.is_some_and(|unit| time_of(unit).is_some())
        || (TIME_NAMES.contains(&first) && time_unit(name).is_some())
}

/// Whether `text` alone is a unit, as in a second header line.
pub fn is_unit(text: &str) -> bool {
    let text = text.trim().trim_matches(['(', ')', '[', ']']);
    unit_of(text).is_some() || time_of(text).is_some()
}

/// The name without a unit in brackets.
pub fn bare(name: &str) -> &str {
    match parts(name) {
        (bare, Some(unit)) if !bare.is_empty() && is_unit(unit) => bare,
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_their_unit() {
        for (name, expected) in [
            ("ax_g", Some((Unit::Gravity, 1.0))),
            ("gx_dps", Some((Unit::DegreePerSecond, 1.0))),
            ("accel_x (m/s^2)", Some((Unit::MetrePerSecondSquared, 1.0))),
            (
                "Acceleration x (m/s²)",
                Some((Unit::MetrePerSecondSquared, 1.0)),
            ),
            ("acc_x_m_s2", Some((Unit::MetrePerSecondSquared, 1.0))),
            ("gyro z [°/s]", Some((Unit::DegreePerSecond, 1.0))),
            ("w_rad_s", Some((Unit::RadianPerSecond, 1.0))),
            ("a_x[mg]", Some((Unit::Gravity, 1e-3))),
            ("out (V)", Some((Unit::Volt, 1.0))),
            ("raw_lsb", Some((Unit::Counts, 1.0))),
            ("ax", None),
            ("g", None),
            ("mag_x_g", None),
            ("accel(x)", None),
            ("temp (degC)", None),
        ] {
            assert_eq!(unit(name), expected, "{name}");
        }
        assert_eq!(bare("accel_x (m/s^2)"), "accel_x");
        assert_eq!(bare("accel(x)"), "accel(x)");
    }

    #[test]
    fn names_say_that_they_are_a_time_and_its_unit() {
        for (name, expected) in [
            ("t [ms]", Some(TimeUnit::Milliseconds)),
            ("millis", Some(TimeUnit::Milliseconds)),
            ("stamp_ns", Some(TimeUnit::Nanoseconds)),
            ("%time", Some(TimeUnit::Nanoseconds)),
            ("timestamp (us)", Some(TimeUnit::Microseconds)),
            ("Time (s)", Some(TimeUnit::Seconds)),
            ("t_s", Some(TimeUnit::Seconds)),
            ("time", None),
        ] {
            assert!(is_time(name), "{name}");
            assert_eq!(time_unit(name), expected, "{name}");
        }
        for name in ["ax", "ax_g", "s", "gyro_ms", "temperature"] {
            assert!(!is_time(name), "{name}");
        }
    }
}
