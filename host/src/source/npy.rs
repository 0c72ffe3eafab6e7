//! NumPy array files as a table: any integer or float type, either byte order, rows or
//! columns first, read in bounded memory.

mod dictionary;
mod elements;
mod header;
mod start;

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use self::elements::{codes, decode};
use self::header::{Header, HeaderError, Kind};
use super::table::Table;
use super::{SourceError, Values};

pub use self::dictionary::MOST_COLUMNS;
pub use self::start::MAGIC;

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
