//! The Allan deviation of a model, as a table.

use std::fmt::Write;

use super::input::Input;
use crate::simulate::file::npy_header;

/// Averaging times an octave.
const PER_OCTAVE: f64 = 4.0;

/// Rows of averaging time (seconds) and one deviation an axis (in its unit).
fn rows(input: &Input) -> Vec<Vec<f64>> {
    let rate_hz = input.model.rate_hz;
    let laws: Vec<_> = input
        .model
        .axes
        .iter()
        .map(|axis| axis.law(rate_hz))
        .collect();
    let octaves = (input.longest_s * rate_hz).max(1.0).log2();
    let mut factors: Vec<u64> = (0..=(octaves * PER_OCTAVE) as u32)
        .map(|step| (f64::from(step) / PER_OCTAVE).exp2().round() as u64)
        .collect();
    factors.dedup();
    factors
        .into_iter()
        .map(|m| {
            let deviations = laws.iter().map(|law| law.allan_variance(m).sqrt());
            std::iter::once(m as f64 / rate_hz)
                .chain(deviations)
                .collect()
        })
        .collect()
}

/// As comma-separated text with a header line and the units above it.
pub fn csv(input: &Input) -> String {
    let mut text = format!("# {}: Allan deviation of the model; tau in s", input.name);
    for axis in &input.model.axes {
        let _ = write!(text, ", {} in {}", axis.name, axis.unit);
    }
    text.push('\n');
    text.push_str(&header(input));
    for row in rows(input) {
        let cells: Vec<String> = row.iter().map(|value| format!("{value:e}")).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// The line with the names of the columns, those with a comma in quotes.
fn header(input: &Input) -> String {
    let names = input.model.axes.iter().map(|axis| axis.name.as_str());
    let mut line = csv::Writer::from_writer(Vec::new());
    // Memory takes what it is given, and what was text still is.
    let _ = line.write_record(std::iter::once("tau_s").chain(names));
    String::from_utf8(line.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// As a NumPy array of doubles: a row for each averaging time, the time in the first column.
pub fn npy(input: &Input) -> Vec<u8> {
    let rows = rows(input);
    let mut bytes = npy_header(rows.len() as u64, 1 + input.model.axes.len());
    bytes.extend(rows.iter().flatten().flat_map(|value| value.to_le_bytes()));
    bytes
}
