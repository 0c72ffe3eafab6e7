//! Appending to a capture.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use inm_protocol::{MAX_FRAME, Note, ToHost, encode};

use super::{CaptureError, Header, MAGIC};

/// A capture being written. Nothing is held back: what [`Writer::append`] has returned from
/// is with the operating system and survives the death of this program.
#[derive(Debug)]
pub struct Writer<W: Write = File> {
    out: W,
    path: PathBuf,
    bytes: u64,
}

impl Writer<File> {
    /// Starts a new capture.
    ///
    /// # Errors
    /// [`CaptureError::Io`] if the file exists (a recording never overwrites one) or cannot
    /// be written.
    pub fn create(path: &Path, header: &Header) -> Result<Self, CaptureError> {
        let out = File::create_new(path).map_err(|source| CaptureError::Io {
            path: path.to_owned(),
            doing: "creating the capture",
            source,
        })?;
        Self::begin(out, path, header)
    }
}

impl<W: Write> Writer<W> {
    /// Starts a capture on any writer; `path` is for messages.
    ///
    /// # Errors
    /// [`CaptureError::Io`] if the header cannot be written.
    pub fn begin(out: W, path: &Path, header: &Header) -> Result<Self, CaptureError> {
        let mut writer = Self {
            out,
            path: path.to_owned(),
            bytes: 0,
        };
        let json = serde_json::to_string(header).map_err(|source| CaptureError::Header {
            path: path.to_owned(),
            source,
        })?;
        writer.append(format!("{MAGIC}\n{json}\n").as_bytes())?;
        Ok(writer)
    }

    /// Appends bytes as they came from the board.
    ///
    /// # Errors
    /// [`CaptureError::Io`], for instance when the disk is full. What was written before
    /// stays readable.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), CaptureError> {
        self.out
            .write_all(bytes)
            .map_err(|source| self.io(source))?;
        self.bytes += bytes.len() as u64;
        Ok(())
    }

    /// Appends a note of the host.
    ///
    /// # Errors
    /// As [`Writer::append`].
    pub fn note(&mut self, note: Note) -> Result<(), CaptureError> {
        self.append(&note_frame(note))
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes written so far, the header included.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    fn io(&self, source: io::Error) -> CaptureError {
        CaptureError::Io {
            path: self.path.clone(),
            doing: "writing the capture",
            source,
        }
    }
}

/// The bytes of a note of the host. A zero ahead of it ends whatever frame was cut off.
pub fn note_frame(note: Note) -> Vec<u8> {
    let mut frame = [0; MAX_FRAME + 1];
    match encode(&ToHost::Note(note), &mut frame[1..]) {
        Ok(len) => frame[..=len].to_vec(),
        // Cannot be: there is room for every message.
        Err(_) => Vec::new(),
    }
}
