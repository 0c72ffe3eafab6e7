//! Whether a remark about something unexplained points to the right place.

use super::answer::Remark;
use crate::hidden::outside::Place;

/// Words that speak of noise whose strength changes in time.
const VARIANCE: [&str; 5] = ["varian", "burst", "strength", "envelope", "cyclic"];

/// Words that speak of a law that is not normal.
const AMPLITUDE: [&str; 6] = [
    "amplitude",
    "skew",
    "tail",
    "kurt",
    "histogram",
    "one-sided",
];

/// Whether any remark does: for a band, names a frequency in or near it.
pub fn is_right(remarks: &[&Remark], place: Place) -> bool {
    remarks.iter().any(|remark| {
        let text = remark.text();
        match place {
            Place::Variance => VARIANCE.iter().any(|word| text.contains(word)),
            Place::Amplitude => AMPLITUDE.iter().any(|word| text.contains(word)),
            Place::Band(lo_hz, hi_hz) => {
                let near = lo_hz / 1.1..hi_hz * 1.1;
                frequencies(&text).iter().any(|f_hz| near.contains(f_hz))
            }
        }
    })
}

/// Frequencies named in a text: numbers with `hz` or `khz` behind them, also over "to", "and",
/// a dash or another number ("120 to 140 Hz"), and numbers behind names that end in `_hz`.
fn frequencies(text: &str) -> Vec<f64> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '+');
    let mut found = Vec::new();
    let mut waiting: Vec<f64> = Vec::new();
    let mut named = false;
    for word in text.split(|c: char| !is_part(c)).filter(|w| !w.is_empty()) {
        let digits = word.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        let unit = &word[digits.len()..];
        if let Ok(number) = digits.parse::<f64>() {
            waiting.push(number);
            if named {
                found.push(number);
                named = false;
            }
        } else if word.ends_with("_hz") {
            named = true;
            continue;
        }
        match if digits.is_empty() { word } else { unit } {
            "hz" => found.append(&mut waiting),
            "khz" => found.extend(waiting.drain(..).map(|number| 1e3 * number)),
            "" | "to" | "and" => {}
            _ => waiting.clear(),
        }
    }
    found
}
