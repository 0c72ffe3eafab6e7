//! NumPy array files as a table: any integer or float type, either byte order, rows or
//! columns first, read in bounded memory.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::npy_header::{Header, HeaderError, Kind};
use super::table::Table;
use super::{SourceError, Values};

/// An open array file.
pub struct NpyTable {
    name: String,
    header: Header,
    input: Input,
    /// Columns to return.
    selected: Vec<usize>,
    /// Whether every integer of the file fits in a converter code.
    fits: bool,
    next_row: u64,
    bytes: Vec<u8>,
}

enum Input {
    /// Rows follow one another.
    Rows(Box<dyn Read>),
    /// Columns follow one another: one reader for each selected column.
    Columns {
        file: Box<Path>,
        readers: Vec<BufReader<File>>,
    },
}

impl NpyTable {
    /// Opens a file on disk, which messages call `name`.
    ///
    /// # Errors
    /// If it cannot be opened, its header is refused, or it is shorter than the header says.
    pub fn open(path: &Path, name: &str) -> Result<Self, SourceError> {
        let name = name.to_owned();
        let io = |error: std::io::Error| SourceError {
            place: name.clone(),
            message: format!("cannot be read: {error}"),
            remedy: String::new(),
        };
        let file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let mut reader = BufReader::with_capacity(1 << 16, file);
        let header = Header::read(&mut reader).map_err(|error| refused(&name, error))?;
        if length < header.data_end() {
            return Err(SourceError {
                place: format!("{name}: byte {length}"),
                message: format!(
                    "the file ends here; {} rows of {} up to byte {} were expected",
                    header.rows,
                    row_text(&header),
                    header.data_end()
                ),
                remedy: "copy the file again, it is cut short".into(),
            });
        }
        let fits = match (header.kind, header.size) {
            (Kind::Float, _) => false,
            (Kind::Signed, 8) | (Kind::Unsigned, 4 | 8) => {
                let fits = all_fit(&mut reader, &header).map_err(io)?;
                reader
                    .seek(SeekFrom::Start(header.data_start))
                    .map_err(io)?;
                fits
            }
            _ => true,
        };
        let input = if header.by_column && header.columns > 1 {
            Input::Columns {
                file: path.into(),
                readers: Vec::new(),
            }
        } else {
            Input::Rows(Box::new(reader))
        };
        Self::new(name, header, input, fits)
    }

    /// Reads from a stream such as standard input.
    ///
    /// Integers wider than 32 bits are read as floats there, because whether all of them fit
    /// in a code is only known at the end.
    ///
    /// # Errors
    /// If the header is refused, or if columns come one after another.
    pub fn stream(name: &str, mut reader: Box<dyn Read>) -> Result<Self, SourceError> {
        let header = Header::read(&mut reader).map_err(|error| refused(name, error))?;
        if header.by_column && header.columns > 1 {
            return Err(SourceError {
                place: name.to_owned(),
                message: "the array is in Fortran order, column after column".into(),
                remedy: "save it to a file and name the file, or save it in C order".into(),
            });
        }
        let fits = !matches!(
            (header.kind, header.size),
            (Kind::Float, _) | (Kind::Signed, 8) | (Kind::Unsigned, 4 | 8)
        );
        Self::new(name.to_owned(), header, Input::Rows(reader), fits)
    }

    fn new(name: String, header: Header, input: Input, fits: bool) -> Result<Self, SourceError> {
        if header.rows == 0 {
            return Err(SourceError {
                place: format!("{name}: byte {}", header.data_start),
                message: "the array holds no samples".into(),
                remedy: String::new(),
            });
        }
        let selected = (0..header.columns).collect();
        Ok(Self {
            name,
            header,
            input,
            selected,
            fits,
            next_row: 0,
            bytes: Vec::new(),
        })
    }

    fn cut(&self, row: u64, error: &std::io::Error) -> SourceError {
        SourceError {
            place: self.place(row),
            message: if error.kind() == std::io::ErrorKind::UnexpectedEof {
                format!("the data end here; {} rows were expected", self.header.rows)
            } else {
                format!("cannot be read: {error}")
            },
            remedy: "copy the file again".into(),
        }
    }
}

fn refused(name: &str, error: HeaderError) -> SourceError {
    SourceError {
        place: format!("{name}: byte {}", error.byte),
        message: error.message,
        remedy: error.remedy.to_owned(),
    }
}

fn row_text(header: &Header) -> String {
    match header.columns {
        1 => format!("{} bytes", header.size),
        columns => format!("{columns} x {} bytes", header.size),
    }
}

/// Whether every element fits in 32 bits with sign.
fn all_fit(reader: &mut impl Read, header: &Header) -> std::io::Result<bool> {
    let mut left = header.data_end() - header.data_start;
    let mut bytes = vec![0; 1 << 16];
    while left > 0 {
        let length = left.min(bytes.len() as u64) as usize;
        reader.read_exact(&mut bytes[..length])?;
        left -= length as u64;
        if codes(header, bytes[..length].chunks_exact(header.size)).is_none() {
            return Ok(false);
        }
    }
    Ok(true)
}

impl Table for NpyTable {
    fn name(&self) -> &str {
        &self.name
    }

    fn header(&self) -> Option<&[String]> {
        None
    }

    fn width(&self) -> usize {
        self.header.columns
    }

    fn rows(&self) -> Option<u64> {
        Some(self.header.rows)
    }

    fn is_integer(&self) -> bool {
        self.header.kind != Kind::Float
    }

    fn place(&self, row: u64) -> String {
        let stride = if self.header.by_column {
            1
        } else {
            self.header.columns as u64
        };
        let byte = self.header.data_start + row * stride * self.header.size as u64;
        format!("{}: row {row} (byte {byte})", self.name)
    }

    fn select(&mut self, columns: &[usize]) -> Result<(), SourceError> {
        self.selected = columns.to_vec();
        let length = self.header.rows * self.header.size as u64;
        if let Input::Columns { file, readers } = &mut self.input {
            for &column in columns {
                let open = || {
                    let mut reader = BufReader::with_capacity(1 << 16, File::open(&**file)?);
                    let at = self.header.data_start + column as u64 * length;
                    reader.seek(SeekFrom::Start(at))?;
                    Ok(reader)
                };
                readers.push(open().map_err(|error: std::io::Error| SourceError {
                    place: self.name.clone(),
                    message: format!("cannot be read: {error}"),
                    remedy: String::new(),
                })?);
            }
        }
        Ok(())
    }

    fn read(&mut self, most: usize) -> Result<Vec<Values>, SourceError> {
        let rows = (self.header.rows - self.next_row).min(most as u64) as usize;
        let size = self.header.size;
        let row = self.next_row;
        let mut columns = Vec::with_capacity(self.selected.len());
        let mut bytes = std::mem::take(&mut self.bytes);
        match &mut self.input {
            Input::Rows(reader) => {
                bytes.resize(rows * self.header.columns * size, 0);
                if let Err(error) = reader.read_exact(&mut bytes) {
                    return Err(self.cut(row, &error));
                }
                for &column in &self.selected {
                    let elements = bytes
                        .chunks_exact(self.header.columns * size)
                        .map(|row| &row[column * size..(column + 1) * size]);
                    columns.push(decode(&self.header, self.fits, elements));
                }
            }
            Input::Columns { readers, .. } => {
                bytes.resize(rows * size, 0);
                for reader in readers {
                    if let Err(error) = reader.read_exact(&mut bytes) {
                        return Err(self.cut(row, &error));
                    }
                    columns.push(decode(&self.header, self.fits, bytes.chunks_exact(size)));
                }
            }
        }
        self.bytes = bytes;
        self.next_row += rows as u64;
        Ok(columns)
    }
}

fn decode<'a>(
    header: &Header,
    fits: bool,
    elements: impl Iterator<Item = &'a [u8]> + Clone,
) -> Values {
    let as_codes = if fits {
        codes(header, elements.clone())
    } else {
        None
    };
    as_codes.map_or_else(
        || Values::Floats(elements.map(|element| float(header, element)).collect()),
        Values::Codes,
    )
}

/// The elements as codes, `None` if one does not fit.
fn codes<'a>(header: &Header, elements: impl Iterator<Item = &'a [u8]>) -> Option<Vec<i32>> {
    elements
        .map(|element| i32::try_from(integer(header, element)).ok())
        .collect()
}

/// An integer element, sign or zero extended.
fn integer(header: &Header, element: &[u8]) -> i128 {
    let word = word(header, element);
    let unused = 64 - 8 * header.size as u32;
    match header.kind {
        Kind::Signed => i128::from(((word << unused) as i64) >> unused),
        _ => i128::from(word),
    }
}

fn float(header: &Header, element: &[u8]) -> f64 {
    let bits = word(header, element);
    match (header.kind, header.size) {
        (Kind::Float, 2) => half(bits as u16),
        (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
        (Kind::Float, _) => f64::from_bits(bits),
        _ => integer(header, element) as f64,
    }
}

/// The bytes of an element as an unsigned word.
fn word(header: &Header, element: &[u8]) -> u64 {
    let fold = |word: u64, &byte: &u8| word << 8 | u64::from(byte);
    if header.big_endian {
        element.iter().fold(0, fold)
    } else {
        element.iter().rev().fold(0, fold)
    }
}

/// IEEE 754 half precision.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    match bits >> 10 & 0x1f {
        0 => sign * fraction * 2_f64.powi(-14),
        0x1f if fraction == 0.0 => sign * f64::INFINITY,
        0x1f => f64::NAN,
        exponent => sign * (1.0 + fraction) * 2_f64.powi(i32::from(exponent) - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(kind: Kind, size: usize, big_endian: bool) -> Header {
        Header {
            kind,
            size,
            big_endian,
            by_column: false,
            rows: 1,
            columns: 1,
            data_start: 0,
        }
    }

    #[test]
    fn elements_of_every_type_and_order() {
        for (kind, size, value) in [
            (Kind::Signed, 1, -5_i128),
            (Kind::Signed, 2, -300),
            (Kind::Signed, 4, i128::from(i32::MIN)),
            (Kind::Signed, 8, -1 << 40),
            (Kind::Unsigned, 1, 250),
            (Kind::Unsigned, 2, 65_000),
            (Kind::Unsigned, 4, 4_000_000_000),
            (Kind::Unsigned, 8, 1 << 63),
        ] {
            let little = &value.to_le_bytes()[..size];
            let big: Vec<u8> = little.iter().rev().copied().collect();
            assert_eq!(integer(&header(kind, size, false), little), value);
            assert_eq!(integer(&header(kind, size, true), &big), value);
        }
        assert_eq!(
            float(&header(Kind::Float, 4, true), &1.5_f32.to_be_bytes()),
            1.5
        );
        assert_eq!(
            float(&header(Kind::Float, 8, false), &(-0.1_f64).to_le_bytes()),
            -0.1
        );
    }

    #[test]
    fn half_precision() {
        assert_eq!(half(0x3c00), 1.0);
        assert_eq!(half(0xc000), -2.0);
        assert_eq!(half(0x7bff), 65504.0);
        assert_eq!(half(0x0001), 2_f64.powi(-24));
        assert_eq!(half(0xfc00), f64::NEG_INFINITY);
        assert!(half(0x7e00).is_nan());
    }
}
