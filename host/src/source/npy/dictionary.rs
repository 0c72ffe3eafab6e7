//! The Python dictionary in the header of a `.npy` file: type, order and shape of the array.

use super::header::{Header, HeaderError, Kind, SAVE_AGAIN};

/// Most columns that are taken for axes: more than any instrument here has; more are a transposed
/// array. Each axis costs a megabyte and a thread.
pub const MOST_COLUMNS: usize = 64;

/// Most rows: with more, an index is no exact `f64` any more, and places in the file would run over 64 bits.
const MOST_ROWS: u64 = 1 << 53;

/// The Python dictionary, with its place in the file.
pub(super) struct Dictionary<'a> {
    text: &'a [u8],
    start: u64,
}

impl<'a> Dictionary<'a> {
    /// The dictionary that begins at byte `start`.
    pub(super) fn new(text: &'a [u8], start: u64) -> Self {
        Self { text, start }
    }

    /// What it says of an array whose elements begin at byte `data_start`.
    ///
    /// # Errors
    /// If a key is missing, or the array is no table of numbers.
    pub(super) fn header(&self, data_start: u64) -> Result<Header, HeaderError> {
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
