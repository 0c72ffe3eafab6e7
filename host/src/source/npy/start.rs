//! The start of a NumPy `.npy` file: a magic word, a version and a Python dictionary.
//!
//! Format versions 1.0, 2.0 and 3.0, as written down in NumPy's own `numpy.lib.format`.

use std::io::Read;

use super::dictionary::Dictionary;
use super::header::{Header, HeaderError, SAVE_AGAIN};

/// First bytes of every `.npy` file.
pub const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest dictionary that is believed, bytes: NumPy itself warns from 10 000.
const LONGEST: u32 = 1 << 20;

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
        Dictionary::new(&text, text_at).header(data_start)
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

#[cfg(test)]
mod tests {
    use super::super::header::Kind;
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
