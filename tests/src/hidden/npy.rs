//! Arrays as NumPy writes them: float64, little-endian, one column an axis.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

/// Writes columns of equal length as a two-dimensional array in C order, one column as a
/// one-dimensional one (NPY format 1.0).
///
/// # Errors
/// If the file cannot be written.
pub fn write(path: &Path, columns: &[&[f64]]) -> io::Result<()> {
    let rows = columns.first().map_or(0, |column| column.len());
    let shape = match columns.len() {
        1 => format!("({rows},)"),
        count => format!("({rows}, {count})"),
    };
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic, version, length and header fill a multiple of 64 bytes; a line feed ends them.
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let length = u16::try_from(header.len()).map_err(io::Error::other)?;
    let mut file = BufWriter::with_capacity(1 << 20, File::create(path)?);
    file.write_all(b"\x93NUMPY\x01\x00")?;
    file.write_all(&length.to_le_bytes())?;
    file.write_all(header.as_bytes())?;
    for row in 0..rows {
        for column in columns {
            file.write_all(&column[row].to_le_bytes())?;
        }
    }
    file.flush()
}
