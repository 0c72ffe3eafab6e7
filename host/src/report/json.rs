//! The result as JSON, schema 1: the structures of [`crate::analyse`] as they are.

use std::io::Write;

use crate::analyse::Analysis;

/// Writes `analysis`, indented and with a newline at the end.
///
/// # Errors
/// If writing fails.
pub fn write(analysis: &Analysis, output: &mut impl Write) -> std::io::Result<()> {
    serde_json::to_writer_pretty(&mut *output, analysis)?;
    writeln!(output)?;
    output.flush()
}
