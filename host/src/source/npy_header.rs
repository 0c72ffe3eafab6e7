//! Header of a NumPy `.npy` file: a magic word, a version and a Python dictionary.
//!
//! Format versions 1.0, 2.0 and 3.0, as written down in NumPy's own `numpy.lib.format`.

use std::io::Read;

/// First bytes of every `.npy` file.
pub const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest dictionary that is believed, bytes: NumPy itself warns from 10 000.
const LONGEST: u32 = 1 << 20;

/// Element type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Signed integer.
    Signed,
    /// Unsigned integer.
    Unsigned,
    /// IEEE floating point: half, single or double.
    Float,
}

/// What the header says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// Element type.
    pub kind: Kind,
    /// Bytes an element: 1, 2, 4 or 8.
    pub size: usize,
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
    /// Whether whole columns follow one another (Fortran order) instead of rows.
    pub by_column: bool,
    /// Number of rows.
    pub rows: u64,
    /// Number of columns; 1 for a vector.
    pub columns: usize,
    /// Byte at which the elements begin.
    pub data_start: u64,
}

/// Why a header is refused: what was found at which byte.
#[derive(Debug, thiserror::Error)]
#[error("byte {byte}: {message}")]
pub struct HeaderError {
    /// Place in the file.
    pub byte: u64,
    /// What was found and what was expected.
    pub message: String,
    /// What to do about it.
    pub remedy: &'static str,
}

const SAVE_AGAIN: &str = "save the array again with numpy.save";

impl Header {
    /// Reads a header and leaves `reader` at the first element.
    ///
    /// # Errors
    /// If it is cut, not a NumPy header, or describes an array that is no table of numbers.
    pub fn read(reader: &mut impl Read) -> Result<Self, HeaderError> {
        let mut start = [0; 8];
        fill(reader, &mut start, 0, "the magic word and the version")?;
        if start[..6] != *MAGIC {
            return Err(HeaderError {
                byte: 0,
                message: "no NumPy magic word (93 4E 55 4D 50 59)".into(),
                remedy: SAVE_AGAIN,
            });
        }
        let (length, text_at) = match start[6] {
            1 => {
                let mut bytes = [0; 2];
                fill(reader, &mut bytes, 8, "the length of the header")?;
                (u32::from(u16::from_le_bytes(bytes)), 10)
            }
            2 | 3 => {
                let mut bytes = [0; 4];
                fill(reader, &mut bytes, 8, "the length of the header")?;
                (u32::from_le_bytes(bytes), 12)
            }
            version => {
                return Err(HeaderError {
                    byte: 6,
                    message: format!("format version {version}; 1, 2 and 3 are known"),
                    remedy: SAVE_AGAIN,
                });
            }
        };
        if length > LONGEST {
            return Err(HeaderError {
                byte: 8,
                message: format!("a header of {length} bytes; at most {LONGEST} are believed"),
                remedy: SAVE_AGAIN,
            });
        }
        let mut text = vec![0; length as usize];
        fill(reader, &mut text, text_at, "the header")?;
        let data_start = text_at + u64::from(length);
        Dictionary {
            text: &text,
            start: text_at,
        }
        .header(data_start)
    }

    /// Byte after the last element.
    pub fn data_end(&self) -> u64 {
        let bytes = (self.columns as u64).saturating_mul(self.size as u64);
        self.data_start
            .saturating_add(self.rows.saturating_mul(bytes))
    }
}

fn fill(reader: &mut impl Read, bytes: &mut [u8], at: u64, what: &str) -> Result<(), HeaderError> {
    reader.read_exact(bytes).map_err(|error| HeaderError {
        byte: at,
        message: if error.kind() == std::io::ErrorKind::UnexpectedEof {
            format!(
                "the file ends within {what} ({} bytes expected here)",
                bytes.len()
            )
        } else {
            format!("cannot read {what}: {error}")
        },
        remedy: "copy the file again, it is cut short",
    })
}

/// The Python dictionary, with its place in the file.
struct Dictionary<'a> {
    text: &'a [u8],
    start: u64,
}

impl Dictionary<'_> {
    fn header(&self, data_start: u64) -> Result<Header, HeaderError> {
        let (descr, at) = self.value("descr")?;
        let (kind, size, big_endian) = self.element(descr, at)?;
        let (order, at) = self.value("fortran_order")?;
        let by_column = match order {
            "True" => true,
            "False" => false,
            other => return Err(self.bad(at, format!("fortran_order {other}, not True or False"))),
        };
        let (shape, at) = self.value("shape")?;
        let (rows, columns) = self.shape(shape, at)?;
        Ok(Header {
            kind,
            size,
            big_endian,
            by_column,
            rows,
            columns,
            data_start,
        })
    }

    fn bad(&self, at: usize, message: String) -> HeaderError {
        HeaderError {
            byte: self.start + at as u64,
            message,
            remedy: SAVE_AGAIN,
        }
    }

    /// The text of the value under `key`, up to the comma outside of brackets, and its place.
    fn value(&self, key: &str) -> Result<(&str, usize), HeaderError> {
        let text = std::str::from_utf8(self.text)
            .map_err(|error| self.bad(error.valid_up_to(), "the header is not text".into()))?;
        let quoted = [format!("'{key}'"), format!("\"{key}\"")];
        let Some(after) = quoted
            .iter()
            .find_map(|quoted| text.find(quoted).map(|at| at + quoted.len()))
        else {
            return Err(self.bad(0, format!("the header does not say `{key}`")));
        };
        let Some(colon) = text[after..].find(':').map(|at| after + at + 1) else {
            return Err(self.bad(after, format!("no value after `{key}`")));
        };
        let mut depth = 0_u32;
        let end = text[colon..]
            .char_indices()
            .find(|&(_, c)| {
                match c {
                    '(' | '[' => depth += 1,
                    ')' | ']' => depth = depth.saturating_sub(1),
                    _ => {}
                }
                depth == 0 && matches!(c, ',' | '}')
            })
            .map_or(text.len(), |(at, _)| colon + at);
        let value = text[colon..end].trim();
        let lead = text[colon..end].len() - text[colon..end].trim_start().len();
        Ok((value, colon + lead))
    }

    fn element(&self, descr: &str, at: usize) -> Result<(Kind, usize, bool), HeaderError> {
        let refuse = |what: &str, remedy| HeaderError {
            byte: self.start + at as u64,
            message: format!("elements of type {descr}: {what}"),
            remedy,
        };
        if descr.starts_with('[') {
            return Err(refuse(
                "a record array; expected plain numbers",
                "save its columns as one two-dimensional array of numbers",
            ));
        }
        let inner = descr.trim_matches(['\'', '"']);
        if inner.contains('O') {
            return Err(refuse(
                "Python objects, which are not read; expected numbers",
                "save with array.astype(float)",
            ));
        }
        let mut letters = inner.chars();
        let order = letters.next().unwrap_or(' ');
        let (letter, digits) = match order {
            '<' | '>' | '|' | '=' => (letters.next().unwrap_or(' '), letters.as_str()),
            letter => (letter, letters.as_str()),
        };
        let size = digits.parse::<usize>().unwrap_or(0);
        let kind = match (letter, size) {
            ('i', 1 | 2 | 4 | 8) => Kind::Signed,
            ('u', 1 | 2 | 4 | 8) => Kind::Unsigned,
            ('f', 2 | 4 | 8) => Kind::Float,
            _ => {
                return Err(refuse(
                    "not read; expected integers i1 to i8, u1 to u8 or floats f2 to f8",
                    "save with array.astype(float)",
                ));
            }
        };
        let big_endian = order == '>' || (order == '=' && cfg!(target_endian = "big"));
        Ok((kind, size, big_endian))
    }

    fn shape(&self, shape: &str, at: usize) -> Result<(u64, usize), HeaderError> {
        let inner = shape
            .strip_prefix('(')
            .and_then(|rest| rest.strip_suffix(')'))
            .ok_or_else(|| self.bad(at, format!("shape {shape} is no tuple")))?;
        let sizes = inner
            .split(',')
            .map(str::trim)
            .filter(|part| !part.is_empty())
            .map(|part| part.trim_end_matches('L').parse::<u64>())
            .collect::<Result<Vec<_>, _>>()
            .map_err(|_| self.bad(at, format!("shape {shape} is no tuple of numbers")))?;
        let refuse = |what: String, remedy| HeaderError {
            byte: self.start + at as u64,
            message: what,
            remedy,
        };
        let (rows, columns) = match sizes[..] {
            [rows] => (rows, 1),
            [rows, columns] => (rows, columns),
            _ => {
                return Err(refuse(
                    format!("shape {shape}; expected one or two dimensions"),
                    "save one column per axis: array.reshape(-1, axes)",
                ));
            }
        };
        if rows > MOST_ROWS {
            return Err(refuse(
                format!("shape {shape} has more rows than any file, {rows}"),
                SAVE_AGAIN,
            ));
        }
        match usize::try_from(columns) {
            Ok(columns @ 1..=MOST_COLUMNS) => Ok((rows, columns)),
            Ok(0) => Err(refuse(format!("shape {shape} has no column"), SAVE_AGAIN)),
            _ => Err(refuse(
                format!("shape {shape} has {columns} columns; expected one column per axis"),
                "save the transpose: numpy.save(file, array.T)",
            )),
        }
    }
}

/// Most columns that are taken for axes: more than any instrument here has; more are a transposed
/// array. Each axis costs a megabyte and a thread.
pub const MOST_COLUMNS: usize = 64;

/// Most rows: with more, an index is no exact `f64` any more, and places in the file would run over 64 bits.
const MOST_ROWS: u64 = 1 << 53;

#[cfg(test)]
mod tests {
    use super::*;

    fn file(dictionary: &str) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend(
            u16::try_from(dictionary.len())
                .expect("short")
                .to_le_bytes(),
        );
        bytes.extend(dictionary.as_bytes());
        bytes
    }

    #[test]
    fn reads_what_numpy_writes() {
        let bytes =
            file("{'descr': '>i2', 'fortran_order': True, 'shape': (1000, 6), }          \n");
        let header = Header::read(&mut &bytes[..]).expect("good header");
        assert_eq!(
            header,
            Header {
                kind: Kind::Signed,
                size: 2,
                big_endian: true,
                by_column: true,
                rows: 1000,
                columns: 6,
                data_start: bytes.len() as u64,
            }
        );
        assert_eq!(header.data_end(), bytes.len() as u64 + 12_000);
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (dictionary, message) in [
            (
                "{'descr': '|O', 'fortran_order': False, 'shape': (3,), }",
                "byte 20: elements",
            ),
            (
                "{'descr': '<c16', 'fortran_order': False, 'shape': (3,), }",
                "not read",
            ),
            (
                "{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (3,), }",
                "record array",
            ),
            (
                "{'descr': '<f8', 'fortran_order': 1, 'shape': (3,), }",
                "not True or False",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (3,4,5), }",
                "dimensions",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 9999), }",
                "9999 columns",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (18446744073709551604, 18), }",
                "more rows than any file",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, }",
                "does not say `shape`",
            ),
        ] {
            let error = Header::read(&mut &file(dictionary)[..]).expect_err(dictionary);
            assert!(error.to_string().contains(message), "{dictionary}: {error}");
        }
        let cut = &file("{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }")[..20];
        let error = Header::read(&mut &cut[..]).expect_err("cut");
        assert!(
            error.to_string().contains("ends within the header"),
            "{error}"
        );
    }
}
