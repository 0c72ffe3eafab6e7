//! Arrays as NumPy writes them, little-endian, one column an axis.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

/// What an array can hold.
pub trait Element: Copy {
    /// Its type, as a header names it.
    const DESCR: &str;

    /// Its bytes, least significant first.
    fn bytes(self) -> impl AsRef<[u8]>;
}

impl Element for f64 {
    const DESCR: &str = "<f8";

    fn bytes(self) -> impl AsRef<[u8]> {
        self.to_le_bytes()
    }
}

impl Element for i32 {
    const DESCR: &str = "<i4";

    fn bytes(self) -> impl AsRef<[u8]> {
        self.to_le_bytes()
    }
}

impl Element for f32 {
    const DESCR: &str = "<f4";

    fn bytes(self) -> impl AsRef<[u8]> {
        self.to_le_bytes()
    }
}

impl Element for i16 {
    const DESCR: &str = "<i2";

    fn bytes(self) -> impl AsRef<[u8]> {
        self.to_le_bytes()
    }
}

/// Writes columns of equal length as a two-dimensional array in C order, one column as a
/// one-dimensional one (NPY format 1.0).
///
/// # Errors
/// If the file cannot be written.
pub fn write<T: Element>(path: &Path, columns: &[&[T]]) -> io::Result<()> {
    let rows = columns.first().map_or(0, |column| column.len());
    let shape = match columns.len() {
        1 => format!("({rows},)"),
        count => format!("({rows}, {count})"),
    };
    let descr = T::DESCR;
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
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
            file.write_all(column[row].bytes().as_ref())?;
        }
    }
    file.flush()
}
