//! Marks that a person sets while a board is recorded: notes in the capture, at their place in the stream.

use std::sync::{Arc, Mutex, PoisonError};

use inm_protocol::{FRAME_END, MAX_MARK, Note};
use jiff::Timestamp;

use super::BoardSource;
use super::talk::Failed;
use crate::link::Arrival;
use crate::plain::{PLAIN, is_plain};

/// Marks that may wait: they are taken with the next bytes of the board, milliseconds later. Who
/// marks faster than that is no person.
const MOST_WAITING: usize = 16;

/// Where marks are set from other threads; clones are of the same recording.
#[derive(Debug, Clone, Default)]
pub struct Marks(Arc<Mutex<Vec<Note>>>);

/// Why a mark was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MarkError {
    /// The text does not fit.
    #[error("the note of a mark is {bytes} bytes; at most {MAX_MARK} fit")]
    TooLong {
        /// Its length, bytes of UTF-8.
        bytes: usize,
    },
    /// Characters that do not show.
    #[error("the note of a mark is to be {PLAIN}")]
    NotPlain,
    /// [`MOST_WAITING`] wait already.
    #[error("{MOST_WAITING} marks wait for the recording; set this one again in a moment")]
    TooMany,
}

impl Marks {
    /// Marks this moment, with a `text` that may be empty.
    ///
    /// # Errors
    /// [`MarkError`]; nothing is marked then.
    pub fn set(&self, text: &str) -> Result<(), MarkError> {
        if !text.is_empty() && !is_plain(text) {
            return Err(MarkError::NotPlain);
        }
        let bytes = text.len();
        let text = text.try_into().map_err(|_| MarkError::TooLong { bytes })?;
        let unix_ms = Timestamp::now().as_millisecond();
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.len() == MOST_WAITING {
            return Err(MarkError::TooMany);
        }
        waiting.push(Note::Mark { unix_ms, text });
        Ok(())
    }

    /// What was marked since the last time, oldest first.
    pub(super) fn take(&self) -> Vec<Note> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl BoardSource {
    /// Where marks are set while it records.
    pub fn marks(&self) -> Marks {
        self.marks.clone()
    }

    /// Takes bytes as they arrived, and looks when health records among them did. A note within a frame would cut
    /// it: what was marked waits for the end of one.
    pub(super) fn arrived(&mut self, bytes: &[u8], arrival: &Arrival) -> Result<(), Failed> {
        let end = bytes.iter().position(|&byte| byte == FRAME_END);
        let (head, tail) = bytes.split_at(end.map_or(0, |end| end + 1));
        self.talk().arrived(head)?;
        self.pairs.look(self.frames.status(), arrival, head.len());
        self.keep_marks_between_frames()?;
        self.talk().arrived(tail)?;
        self.pairs.look(self.frames.status(), arrival, bytes.len());
        Ok(())
    }

    /// What was marked since the last time, into the capture, unless a frame has begun there.
    pub(super) fn keep_marks_between_frames(&mut self) -> Result<(), Failed> {
        if self.frames.is_within_a_frame() {
            return Ok(());
        }
        self.keep_marks()
    }

    /// What was marked since the last time, into the capture: the last of it. What the clocks said goes with it.
    pub(super) fn keep_marks(&mut self) -> Result<(), Failed> {
        for note in self.pairs.take().into_iter().chain(self.marks.take()) {
            self.note(note)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_stand_in_a_capture_is_refused() {
        let marks = Marks::default();
        let longest = "\u{e9}".repeat(MAX_MARK / 2);
        let too_long = format!("{longest}.");
        let bytes = too_long.len();
        assert_eq!(marks.set(&too_long), Err(MarkError::TooLong { bytes }));
        assert_eq!(marks.set("a\u{1b}[2J"), Err(MarkError::NotPlain));
        assert!(marks.take().is_empty());
        assert_eq!(marks.set(&longest), Ok(()));
        assert_eq!(marks.set(""), Ok(()));
        let texts = marks.take().into_iter().map(|note| match note {
            Note::Mark { text, .. } => text.as_str().to_owned(),
            other => panic!("{other:?}"),
        });
        assert_eq!(texts.collect::<Vec<_>>(), [longest.as_str(), ""]);
    }

    #[test]
    fn marks_that_nobody_takes_are_bounded() {
        let marks = Marks::default();
        for _ in 0..MOST_WAITING {
            assert_eq!(marks.set("again"), Ok(()));
        }
        assert_eq!(marks.set("again"), Err(MarkError::TooMany));
        assert_eq!(marks.take().len(), MOST_WAITING);
        assert_eq!(marks.set("again"), Ok(()));
    }
}
