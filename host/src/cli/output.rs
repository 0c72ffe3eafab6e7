//! Files that results go to; `-` is standard output.

use std::fs::File;
use std::io::{BufWriter, Write};

use anyhow::Context;

/// Writes to the file `path`, or to standard output if it is `-`.
///
/// # Errors
/// If the file cannot be created or written; the message names it.
pub fn write_to(
    path: &str,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> anyhow::Result<()> {
    if path == "-" {
        let mut output = BufWriter::new(std::io::stdout().lock());
        write(&mut output)?;
        output.flush()?;
        return Ok(());
    }
    let file = File::create(path).with_context(|| format!("{path}: cannot be created"))?;
    let mut output = BufWriter::new(file);
    write(&mut output)
        .and_then(|()| output.flush())
        .with_context(|| format!("{path}: cannot be written"))
}
