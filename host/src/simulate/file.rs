//! Writes a simulation as an array file, block after block.

use std::io::Write;

use super::source::Simulation;
use crate::signal::Unit;
use crate::source::Source;
use crate::source::npy::MAGIC;

/// Rows written at a time.
const ROWS: usize = 8192;

/// NumPy aligns the elements to this many bytes.
const ALIGNMENT: usize = 64;

/// Writes `simulation` as a `.npy` array of doubles, one column an axis; a single axis as a
/// vector.
///
/// # Errors
/// If writing fails.
pub fn write_npy(simulation: &mut Simulation, output: &mut impl Write) -> std::io::Result<()> {
    let axes = simulation.signal().axes.len();
    let rows = simulation.expected_len().unwrap_or(0);
    output.write_all(&npy_header(rows, axes))?;
    let mut bytes = Vec::with_capacity(ROWS * axes * 8);
    loop {
        let columns = simulation.next_columns(ROWS);
        let count = columns.first().map_or(0, Vec::len);
        if count == 0 {
            return output.flush();
        }
        bytes.clear();
        for row in 0..count {
            for column in &columns {
                bytes.extend(column[row].to_le_bytes());
            }
        }
        output.write_all(&bytes)?;
    }
}

/// Header of an array of little-endian doubles, format version 1.0; one column is a vector.
pub fn npy_header(rows: u64, columns: usize) -> Vec<u8> {
    let shape = if columns == 1 {
        format!("({rows},)")
    } else {
        format!("({rows}, {columns})")
    };
    let mut text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic word, version and length take 10 bytes; the text ends in a newline.
    let padding = ALIGNMENT - (10 + text.len() + 1) % ALIGNMENT;
    text.extend(std::iter::repeat_n(' ', padding));
    text.push('\n');
    let mut header = MAGIC.to_vec();
    header.extend([1, 0]);
    // Two numbers of at most twenty digits: far below 65 536.
    header.extend((text.len() as u16).to_le_bytes());
    header.extend(text.as_bytes());
    header
}

/// Writes `simulation` as comma-separated text with a header line that says names and units. Numbers
/// are written so that they read back exactly.
///
/// # Errors
/// If writing fails.
pub fn write_csv(simulation: &mut Simulation, output: &mut impl Write) -> std::io::Result<()> {
    let axes = simulation.signal().axes.iter();
    // What was given beside the axes has no unit of theirs.
    let names = axes.map(|axis| match axis.unit {
        Unit::Counts => axis.name.clone(),
        unit => format!("{} [{unit}]", axis.name),
    });
    let mut header = csv::Writer::from_writer(&mut *output);
    header.write_record(names)?;
    header.flush()?;
    drop(header);
    loop {
        let columns = simulation.next_columns(ROWS);
        let count = columns.first().map_or(0, Vec::len);
        if count == 0 {
            return output.flush();
        }
        for row in 0..count {
            for (index, column) in columns.iter().enumerate() {
                let comma = if index == 0 { "" } else { "," };
                write!(output, "{comma}{:e}", column[row])?;
            }
            writeln!(output)?;
        }
    }
}
