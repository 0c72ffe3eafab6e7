//! Two effects that can be in one record without either being a matter of the other.

use super::effect::{Kind, find};

/// Names of the pairs: seen in different views, or far apart in the same.
pub const PAIRS: [[&str; 2]; 12] = [
    ["hum", "steps"],
    ["sinusoid", "burst"],
    ["sinusoid", "outliers"],
    ["markov", "outliers"],
    ["markov", "stale"],
    ["resonance", "steps"],
    ["resonance", "clipping"],
    ["warmup", "hum"],
    ["thermal", "hum"],
    ["telegraph", "stale"],
    ["burst", "steps"],
    ["rolloff", "outliers"],
];

/// The kinds of all pairs.
pub fn all() -> Vec<Vec<&'static Kind>> {
    PAIRS
        .iter()
        .map(|names| names.iter().filter_map(|name| find(name)).collect())
        .collect()
}
