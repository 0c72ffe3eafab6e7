//! What is asked of an array file: its rate, and the samples of a part of it.

use std::ops::Range;

use crate::signal::{POSSIBLE_RATE, POSSIBLE_RATE_HZ};
use crate::source::SourceError;
use crate::source::options::ArrayOptions;

/// The rate where no stamps give it, samples a second.
pub(super) fn rate(name: &str, options: &ArrayOptions) -> Result<f64, SourceError> {
    let bad = |message: String, remedy: &str| SourceError {
        place: name.to_owned(),
        message,
        remedy: remedy.to_owned(),
    };
    match options.rate_hz {
        Some(rate_hz) if POSSIBLE_RATE_HZ.contains(&rate_hz) => Ok(rate_hz),
        Some(rate_hz) => Err(bad(
            format!("a rate of {rate_hz:?} samples a second; expected {POSSIBLE_RATE}"),
            "give --rate HZ as it is",
        )),
        None => Err(bad(
            "the file does not say how fast it was sampled".into(),
            "give --rate HZ, or --time COLUMN if a column holds the time",
        )),
    }
}

/// The samples between `--from` and `--to`.
pub(super) fn part(
    name: &str,
    rows: Option<u64>,
    rate_hz: f64,
    options: &ArrayOptions,
) -> Result<Range<u64>, SourceError> {
    let index = |seconds: Option<f64>| seconds.map(|seconds| (seconds * rate_hz).round());
    let from = index(options.from_s).unwrap_or(0.0);
    let to = index(options.to_s).unwrap_or(f64::INFINITY);
    let limit = rows.map_or(f64::INFINITY, |rows| rows as f64);
    // Written so that NaN is refused as well.
    let sound = from >= 0.0 && from < to && from < limit;
    if !sound {
        return Err(SourceError {
            place: name.to_owned(),
            message: "no sample lies between --from and --to".into(),
            remedy: match rows {
                Some(_) => format!("the file covers 0 to {} s", limit / rate_hz),
                None => "--from comes before --to, both in seconds from the start".into(),
            },
        });
    }
    // Saturates where there is no end.
    Ok(from as u64..to as u64)
}
