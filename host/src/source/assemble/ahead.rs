//! What is told of a stream ahead of its first batch that arrives.

use std::ops::Range;

use inm_protocol::{AXES, Batch};

/// Words of one stream that must not be used, by axis, in the board's own count.
#[derive(Debug, Default)]
pub(super) struct Ahead {
    stream: u16,
    words: [Range<u64>; AXES],
}

impl Ahead {
    /// These words of an axis must not be used. Of any stream but the last one told of, nothing is
    /// needed any more.
    pub fn spoil(&mut self, stream: u16, axis: usize, words: Range<u64>) {
        if self.stream != stream {
            *self = Self {
                stream,
                ..Self::default()
            };
        }
        let Some(known) = self.words.get_mut(axis) else {
            return;
        };
        *known = match known.is_empty() {
            true => words,
            false => known.start.min(words.start)..known.end.max(words.end),
        };
    }

    /// What of it concerns the stream that begins with this batch.
    pub fn take(&mut self, batch: &Batch) -> [Range<u64>; AXES] {
        let told = std::mem::take(self);
        if told.stream != batch.stream {
            return Default::default();
        }
        let from = batch.first;
        told.words
            .map(|words| words.start.max(from)..words.end.max(from))
    }
}
