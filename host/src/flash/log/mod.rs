//! What the board's log says: frames of defmt in words, by the table of strings in the image that the board runs.
//!
//! ```text
//!   table    the strings of an ELF file by their numbers
//!   frames   the stream to frames: each ends with a zero, and has none else (rzCOBS)
//!   words    a frame to words: format strings by `defmt-parser`
//! ```
//!
//! The board sends numbers of strings and their arguments; the strings are in the ELF file only. The project's own
//! decoder, `defmt-decoder`, is not used: it makes serde_json, which writes and reads every result here, keep numbers as
//! text, and what is flattened is not read back then. Of the types of defmt those are known that a
//! firmware of this project logs; a frame with another one is counted as one that could not be read.

mod frames;
mod table;
#[cfg(test)]
mod tests;
mod words;

use jiff::Timestamp;
use serde::Serialize;

use self::frames::Frames;
pub use self::table::LogTable;

/// One line of the log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// Wall clock of this machine when it was read, RFC 3339.
    pub at: String,
    /// The board's own time, seconds since it started; `None` of what this program says, and where the image has none.
    pub up_s: Option<f64>,
    /// `trace`, `debug`, `info`, `warn` or `error`; `None` of what this program says.
    pub level: Option<&'static str>,
    /// The crate of the firmware that says it; `None` of what this program says.
    pub from: Option<String>,
    /// What happened, in words.
    pub what: String,
}

impl Line {
    /// A line in our own words, at this moment.
    pub fn say(what: impl Into<String>) -> Self {
        Self {
            at: Timestamp::now().to_string(),
            up_s: None,
            level: None,
            from: None,
            what: what.into(),
        }
    }
}

/// What one life of a board sends, on its way to lines.
pub struct Decoder<'t> {
    table: &'t LogTable,
    frames: Frames,
    /// Frames that could not be read, since the last one that could.
    lost: u32,
}

impl LogTable {
    /// Begins to decode what a board sends, from its start on or from any moment.
    pub fn decoder(&self) -> Decoder<'_> {
        Decoder {
            table: self,
            frames: Frames::default(),
            lost: 0,
        }
    }
}

impl Decoder<'_> {
    /// Takes bytes as they came, and returns the lines that are complete.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<Line> {
        let mut lines = Vec::new();
        for frame in self.frames.take(bytes) {
            match frame.and_then(|frame| words::line(self.table, &frame)) {
                Some(line) => {
                    if self.lost > 0 {
                        lines.push(Line::say(format!(
                            "{} frames of the log cannot be read: the board had more to say than was fetched",
                            std::mem::take(&mut self.lost)
                        )));
                    }
                    lines.push(line);
                }
                None => self.lost = self.lost.saturating_add(1),
            }
        }
        lines
    }
}
