//! Appending to a capture.

use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use inm_protocol::{MAX_FRAME, Note, ToHost, encode};

use super::durable::{Durable, NewFile};
use super::{CaptureError, Header, MAGIC};

/// Longest time that bytes wait for the disk while the recording runs: what a loss of power costs, beside
/// what the disk itself takes. More often would keep a disk awake that does nothing else.
pub const SYNC_PERIOD: Duration = Duration::from_secs(1);

/// A capture being written. Nothing is held back: what [`Writer::append`] has returned from
/// is with the operating system and survives the death of this program. Header and name are on the
/// disk before the first frame; frames are [`SYNC_PERIOD`] later at most.
pub struct Writer {
    out: Box<dyn Durable>,
    path: PathBuf,
    bytes: u64,
    /// Bytes that are on the disk.
    synced: u64,
    /// When they were last brought there.
    synced_at: Instant,
}

impl Writer {
    /// Whether there is no file at `path` yet.
    ///
    /// # Errors
    /// [`CaptureError::Io`] if there is one.
    pub fn check_new(path: &Path) -> Result<(), CaptureError> {
        if path.symlink_metadata().is_ok() {
            return Err(CaptureError::Io {
                path: path.to_owned(),
                doing: "creating the capture",
                source: io::ErrorKind::AlreadyExists.into(),
            });
        }
        Ok(())
    }

    /// Starts a new capture.
    ///
    /// # Errors
    /// [`CaptureError::Io`] if the file exists (a recording never overwrites one) or cannot
    /// be written.
    pub fn create(path: &Path, header: &Header) -> Result<Self, CaptureError> {
        let out = NewFile::create(path).map_err(|source| CaptureError::Io {
            path: path.to_owned(),
            doing: "creating the capture",
            source,
        })?;
        Self::begin(Box::new(out), path, header)
    }

    /// Starts a capture on anything; `path` is for messages.
    ///
    /// # Errors
    /// [`CaptureError::Io`] if the header cannot be written, or brought to the disk.
    pub fn begin(
        out: Box<dyn Durable>,
        path: &Path,
        header: &Header,
    ) -> Result<Self, CaptureError> {
        let mut writer = Self {
            out,
            path: path.to_owned(),
            bytes: 0,
            synced: 0,
            synced_at: Instant::now(),
        };
        let json = serde_json::to_string(header).map_err(|source| CaptureError::Header {
            path: path.to_owned(),
            source,
        })?;
        writer.append(format!("{MAGIC}\n{json}\n").as_bytes())?;
        writer.sync()?;
        writer
            .out
            .sync_name()
            .map_err(|source| writer.io("bringing the capture's name to the disk", source))?;
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
            .map_err(|source| self.io("writing the capture", source))?;
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

    /// Brings to the disk what has waited for [`SYNC_PERIOD`] at `now`; to be called more often than
    /// that.
    ///
    /// # Errors
    /// [`CaptureError::Io`]; what the disk has stays readable.
    pub fn sync_if_due(&mut self, now: Instant) -> Result<(), CaptureError> {
        if self.bytes > self.synced && now.duration_since(self.synced_at) >= SYNC_PERIOD {
            self.sync()?;
            self.synced_at = now;
        }
        Ok(())
    }

    /// Brings everything to the disk, as at the end of a recording.
    ///
    /// # Errors
    /// [`CaptureError::Io`]; what the disk has stays readable.
    pub fn sync(&mut self) -> Result<(), CaptureError> {
        self.out
            .sync()
            .map_err(|source| self.io("bringing the capture to the disk", source))?;
        self.synced = self.bytes;
        Ok(())
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Bytes written so far, the header included.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    fn io(&self, doing: &'static str, source: io::Error) -> CaptureError {
        CaptureError::Io {
            path: self.path.clone(),
            doing,
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
