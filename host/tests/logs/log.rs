//! A log, and what is true of it.

use inm_host::internals::model::Seed;
use inm_host::internals::model::random::Gaussian;

/// Standard deviation of the white noise in every axis.
pub const DEVIATION: f64 = 0.02;

/// Rows of a log, if nothing was lost: more than are read at a time, and than are transformed as a
/// whole (8192 both), which takes ten times as long.
pub const ROWS: usize = 9000;

/// A log as somebody has it.
pub struct Log {
    pub what: &'static str,
    pub text: String,
    /// Options that its owner gives.
    pub say: &'static str,
    /// Part of the message with which these are refused, and those that do.
    pub refused: Option<(&'static str, &'static str)>,
    pub rate_hz: f64,
    /// Part of the rate that it may be off by: what rounding and jitter of the stamps leave open.
    pub rate_within: f64,
    pub unit: &'static str,
    /// Units that a number of the file is worth.
    pub worth: f64,
    pub axes: usize,
    pub samples: usize,
    pub lost: usize,
    pub gaps: usize,
    pub invalid: usize,
    /// Part of a note.
    pub news: &'static str,
}

impl Log {
    /// Two axes in g, 100 a second, nothing missing.
    pub fn new(what: &'static str, say: &'static str, text: String) -> Self {
        Self {
            what,
            text,
            say,
            refused: None,
            rate_hz: 100.0,
            rate_within: 1e-9,
            unit: "g",
            worth: 1.0,
            axes: 2,
            samples: ROWS,
            lost: 0,
            gaps: 0,
            invalid: 0,
            news: "",
        }
    }
}

/// White noise of two axes at index `index`, the same in every log.
pub fn noise() -> Vec<[f64; 2]> {
    let mut axes = [0, 1].map(|stream| Gaussian::new(Seed { seed: 14, stream }, DEVIATION));
    (0..ROWS)
        .map(|_| axes.each_mut().map(Gaussian::draw))
        .collect()
}

/// A header line, and for each index that is `kept` a line of the stamp and two values.
pub fn stamped(
    header: &str,
    kept: impl Fn(usize) -> bool,
    stamp: impl Fn(usize) -> String,
) -> String {
    let mut text = format!("{header}\n");
    for (index, [x, y]) in noise()
        .into_iter()
        .enumerate()
        .filter(|(index, _)| kept(*index))
    {
        text += &format!("{},{x:.6},{y:.6}\n", stamp(index));
    }
    text
}

/// Two values a line, made into text by `line`.
pub fn rows(line: impl Fn(usize, f64, f64) -> String) -> String {
    let rows = noise().into_iter().enumerate();
    rows.map(|(index, [x, y])| line(index, x, y)).collect()
}
