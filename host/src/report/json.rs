//! A result as JSON, schema 1: the structures of [`crate::analyse`] and
//! [`crate::diagnosis::result::finding`] as they are.

use std::io::Write;

use serde::Serialize;

/// Writes `result`, indented and with a newline at the end.
///
/// # Errors
/// If writing fails.
pub fn write(result: &impl Serialize, output: &mut impl Write) -> std::io::Result<()> {
    serde_json::to_writer_pretty(&mut *output, result)?;
    writeln!(output)?;
    output.flush()
}
