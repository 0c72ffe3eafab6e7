//! Reading a capture, whole or cut.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use inm_protocol::VERSION;

use super::{CaptureError, Header, MAGIC};

/// Longest header line that is believed; a longer one is not a capture.
const MAX_HEADER: u64 = 1 << 20;

/// A capture open for reading: the header is read, the frames follow through [`Read`].
#[derive(Debug)]
pub struct Reader<R = BufReader<File>> {
    input: R,
    path: PathBuf,
    header: Header,
    header_line: String,
}

impl Reader {
    /// Opens a capture and reads its header.
    ///
    /// # Errors
    /// [`CaptureError`] if the file cannot be read, is not a capture, or is one of another
    /// protocol version.
    pub fn open(path: &Path) -> Result<Self, CaptureError> {
        let file = File::open(path).map_err(|source| CaptureError::Io {
            path: path.to_owned(),
            doing: "opening the capture",
            source,
        })?;
        Self::new(BufReader::with_capacity(1 << 16, file), path)
    }
}

impl<R: BufRead> Reader<R> {
    /// Reads the header from any reader; `path` is for messages.
    ///
    /// # Errors
    /// As [`Reader::open`].
    pub fn new(mut input: R, path: &Path) -> Result<Self, CaptureError> {
        let mut read_line = |limit: u64| -> Result<Vec<u8>, CaptureError> {
            let mut line = Vec::new();
            input
                .by_ref()
                .take(limit)
                .read_until(b'\n', &mut line)
                .map_err(|source| CaptureError::Io {
                    path: path.to_owned(),
                    doing: "reading the header",
                    source,
                })?;
            Ok(line)
        };
        let magic = read_line(MAGIC.len() as u64 + 1)?;
        if magic.strip_suffix(b"\n") != Some(MAGIC.as_bytes()) {
            return Err(
                if !magic.is_empty() && MAGIC.as_bytes().starts_with(&magic) {
                    CaptureError::CutHeader {
                        path: path.to_owned(),
                        at: magic.len() as u64,
                    }
                } else {
                    CaptureError::NotACapture {
                        path: path.to_owned(),
                    }
                },
            );
        }
        let line = read_line(MAX_HEADER)?;
        let Some(json) = line.strip_suffix(b"\n") else {
            return Err(CaptureError::CutHeader {
                path: path.to_owned(),
                at: (magic.len() + line.len()) as u64,
            });
        };
        let header = header(json, path)?;
        let header_line = String::from_utf8_lossy(json).into_owned();
        Ok(Self {
            input,
            path: path.to_owned(),
            header,
            header_line,
        })
    }

    /// What the capture says about itself.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The header line as it stands in the file, for a copy that is the same to the byte.
    pub fn header_line(&self) -> &str {
        &self.header_line
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// The header from its line of JSON; `path` is for messages.
fn header(json: &[u8], path: &Path) -> Result<Header, CaptureError> {
    let bad_header = |source| CaptureError::Header {
        path: path.to_owned(),
        source,
    };
    // The version first: another version may have another header.
    let value: serde_json::Value = serde_json::from_slice(json).map_err(bad_header)?;
    match value.get("protocol").and_then(serde_json::Value::as_u64) {
        Some(theirs) if !(1..=u64::from(VERSION)).contains(&theirs) => {
            let theirs = u8::try_from(theirs).unwrap_or(u8::MAX);
            return Err(CaptureError::Protocol {
                path: path.to_owned(),
                theirs,
            });
        }
        _ => {}
    }
    let header: Header = serde_json::from_value(value).map_err(bad_header)?;
    header.check().map_err(|impossible| CaptureError::Number {
        path: path.to_owned(),
        field: impossible.field,
        found: impossible.found,
        expected: impossible.expected,
    })?;
    Ok(header)
}

impl<R: BufRead> Read for Reader<R> {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        self.input.read(buf)
    }
}
