//! A capture file as a source.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::time::{Duration, Instant};

use super::assemble::Losses;
use super::audit::Proof;
use super::frames::{Frames, Status};
use super::{Chunk, Source, SourceError};
use crate::capture::{CaptureError, Header, Reader};
use crate::clocks::Clocks;
use crate::signal::Signal;

/// Bytes read at a time: some 400 frames.
const BUFFER: usize = 1 << 16;

/// Reads a capture down the path that live data take.
#[derive(Debug)]
pub struct CaptureSource {
    reader: Reader<Input>,
    signal: Signal,
    frames: Frames,
    buf: Vec<u8>,
    ended: bool,
    pace: Option<Pace>,
    /// That it holds no sample has been said.
    said_empty: bool,
}

/// A file, or a stream.
struct Input(Box<dyn BufRead>);

impl std::fmt::Debug for Input {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Input")
    }
}

impl Read for Input {
    fn read(&mut self, buf: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(buf)
    }
}

impl BufRead for Input {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        self.0.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        self.0.consume(amount);
    }
}

/// Holds a replay back to the time of the record.
#[derive(Debug)]
struct Pace {
    speed: f64,
    started: Instant,
}

impl CaptureSource {
    /// Opens the capture at `path`.
    ///
    /// # Errors
    /// As [`Reader::open`].
    pub fn open(path: &Path) -> Result<Self, CaptureError> {
        let file = File::open(path).map_err(|source| CaptureError::Io {
            path: path.to_owned(),
            doing: "opening the capture",
            source,
        })?;
        Self::read(Box::new(BufReader::with_capacity(BUFFER, file)), path)
    }

    /// Reads a capture from a stream, which messages call `name`.
    ///
    /// # Errors
    /// As [`Reader::new`].
    pub fn read(input: Box<dyn BufRead>, name: &Path) -> Result<Self, CaptureError> {
        let reader = Reader::new(Input(input), name)?;
        let signal = reader.header().signal(name)?;
        let buf = vec![0; BUFFER];
        let mut frames = Frames::default();
        frames.begin(&reader.header().board);
        Ok(Self {
            reader,
            signal,
            frames,
            buf,
            ended: false,
            pace: None,
            said_empty: false,
        })
    }

    /// Replays at `speed` seconds of the record in a second; 0 is as fast as it goes.
    #[must_use]
    pub fn at_speed(mut self, speed: f64) -> Self {
        self.pace = (speed > 0.0).then(|| Pace {
            speed,
            started: Instant::now(),
        });
        self
    }

    /// What the capture says about itself.
    pub fn header(&self) -> &Header {
        self.reader.header()
    }

    /// Samples lost and flagged so far.
    pub fn losses(&self) -> Losses {
        self.frames.losses()
    }

    /// Frames that arrived damaged, and their bytes.
    pub fn damaged(&self) -> (u64, u64) {
        self.frames.damaged()
    }

    /// Samples an axis so far, lost ones included.
    pub fn next_index(&self) -> u64 {
        self.frames.next_index()
    }

    /// Board and link so far.
    pub fn status(&self) -> &Status {
        self.frames.status()
    }

    /// Why there is nothing to make anything of.
    fn empty(&self) -> SourceError {
        SourceError {
            place: self.signal.name.clone(),
            message: format!(
                "the capture holds no samples: behind its header are {} whole frames of other kinds \
                 and {} damaged ones",
                self.frames.intact(),
                self.damaged().0
            ),
            remedy: "record again; the notes of `inm replay` say what the board said".into(),
        }
    }

    fn read_more(&mut self) -> Result<(), SourceError> {
        let len = self
            .reader
            .read(&mut self.buf)
            .map_err(|source| CaptureError::Io {
                path: self.reader.path().to_owned(),
                doing: "reading the capture",
                source,
            })?;
        if len > 0 {
            self.frames.push(&self.buf[..len]);
            if let Some(pace) = &self.pace {
                let record_s = self.frames.next_index() as f64 / self.signal.rate_hz;
                let due = Duration::from_secs_f64(record_s / pace.speed);
                std::thread::sleep(due.saturating_sub(pace.started.elapsed()));
            }
            return Ok(());
        }
        self.ended = true;
        self.frames.finish();
        Ok(())
    }
}

impl Source for CaptureSource {
    fn signal(&self) -> &Signal {
        &self.signal
    }

    fn proof(&self) -> Option<Proof> {
        Some(self.frames.proof())
    }

    fn clocks(&self) -> Option<Clocks> {
        self.frames.clocks()
    }

    fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
        loop {
            if let Some(chunk) = self.frames.pop() {
                return Ok(Some(chunk));
            }
            if self.ended && self.next_index() == 0 && !self.said_empty {
                self.said_empty = true;
                return Err(self.empty());
            }
            if self.ended {
                return Ok(None);
            }
            self.read_more()?;
        }
    }
}
