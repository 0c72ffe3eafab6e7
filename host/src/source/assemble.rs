//! Batches into blocks: continuity, loss, and words that must not be used.

mod ahead;
mod building;
mod held;
mod line;
mod losses;
mod ranges;
mod spoilt;
mod streams;
mod stretches;

use std::collections::VecDeque;
use std::ops::Range;

use inm_protocol::{AXES, Batch, Event};

use self::ahead::Ahead;
use self::held::Held;
use self::spoilt::Spoilt;
use self::streams::Streams;
use self::stretches::{Stretch, Stretches};
use super::{Chunk, Gap};

pub use self::losses::Losses;

/// Conversions that may have passed between a slipped bit and its notice on a board of 0.1.0, whose
/// captures stay readable; since then it is [`inm_protocol::UNPROVEN_PERIODS`], which this includes.
pub const SLIP_NOTICE: u64 = 540;

/// Samples that are held where the board says nothing of itself: what a notice may spoil, and some
/// batches on their way.
pub const HELD: u64 = 640;

/// Samples that are held at most until the board has confirmed that all its notices have arrived,
/// as it does once a second: two seconds at 4000/s, so that one health record may be lost, too.
const LONGEST_HELD: u64 = 10_000;

/// Longest gap whose samples are counted: 18 hours at 4000/s. What makes room for each sample of a
/// record stays payable; beyond that a gap is of unknown length.
const LONGEST_GAP: u64 = 1 << 28;

/// Samples an axis after which a block is handed on.
const BLOCK: u64 = 4096;

/// Puts batches together into long blocks and reports every hole between them.
///
/// Words near a clipped one are marked too, and those ahead of the notice of a fault. To be able to
/// mark backwards, samples wait for what is still to be said about them, across gaps: until the board
/// has [confirmed](Self::confirm) that every notice has arrived, or [`HELD`] of them.
#[derive(Debug, Default)]
pub struct Assembler {
    held: Held,
    /// Nothing more will be said about samples before this index; `None` where the board does not
    /// tell.
    confirmed: Option<u64>,
    seq: Option<u32>,
    streams: Streams,
    /// What was told of a stream of which nothing else has arrived.
    ahead: Ahead,
    stretches: Stretches,
    /// Index that should come next, offset included.
    next: Option<u64>,
    spoilt: Spoilt,
    losses: Losses,
    /// Why the next gap is there, where more is known than the batches tell.
    cause: Option<String>,
    /// The first gaps of unknown length, up to [`LISTED`].
    unknown: Vec<Gap>,
    done: VecDeque<Chunk>,
}

/// Gaps of unknown length that are listed at the end of a recording: each is a misfortune of its
/// own, and a board that has more of them in a night has told enough.
const LISTED: usize = 32;

impl Assembler {
    /// Takes the next batch that arrived intact.
    pub fn push(&mut self, batch: &Batch) {
        let first = self.place(batch);
        self.stretches.push(batch, self.next == Some(first));
        self.cause = None;
        if self.streams.begin_or_extend(batch) {
            self.begin(first, batch);
        }
        self.seq = Some(batch.seq);
        self.next = Some(first + batch.codes.len() as u64);
        self.append(first, batch);
        let until = self.certain();
        let is_long = |oldest| until.saturating_sub(oldest) >= BLOCK;
        if self.held.oldest().is_some_and(is_long) {
            self.held.release(until, &mut self.done);
        }
    }

    /// The longest stretch without a gap: over one, converters may have been synchronised anew.
    pub fn longest_stretch(&self) -> Stretch {
        self.stretches.longest()
    }

    /// A stream begins with this batch, sample `first` of the record.
    fn begin(&mut self, first: u64, batch: &Batch) {
        if batch.stream != 0 {
            // Every board that numbers its streams confirms them.
            self.confirmed.get_or_insert(first);
        }
        for (axis, range) in self.ahead.take(batch).into_iter().enumerate() {
            let [from, to] = [range.start, range.end].map(|at| self.streams.place(at));
            self.spoil_range(axis, from..to);
        }
    }

    /// Index of a batch in the record, once the gap ahead of it is told.
    fn place(&mut self, batch: &Batch) -> u64 {
        let mut first = self.streams.place(batch.first);
        let lost_batches = self
            .seq
            .map_or(0, |seq| batch.seq.wrapping_sub(seq.wrapping_add(1)));
        match self.next {
            None if first > LONGEST_GAP => first = self.streams.anew(batch, 0),
            Some(next) if first < next || self.streams.is_another(batch.stream) => {
                // The board has counted from 0 again: how much time passed is not known.
                first = self.streams.anew(batch, next + 1);
                self.losses.restarts += 1;
                self.gap(
                    next,
                    None,
                    "the board started again from index 0".to_owned(),
                );
            }
            Some(next) if first - next > LONGEST_GAP => {
                let jump = first - next;
                first = self.streams.anew(batch, next + 1);
                self.gap(
                    next,
                    None,
                    format!("the index jumps by {jump}, which no record can hold"),
                );
            }
            Some(next) if first > next => {
                self.losses.lost_batches += u64::from(lost_batches);
                self.losses.lost_samples += first - next;
                let cause = match lost_batches {
                    0 => "the converters gave no samples".to_owned(),
                    1 => "1 batch was lost on the link".to_owned(),
                    n => format!("{n} batches were lost on the link"),
                };
                self.gap(next, Some(first), cause);
            }
            _ => {}
        }
        first
    }

    /// Hands on what is complete, without waiting for a long block.
    pub fn flush(&mut self) {
        self.held.release(self.certain(), &mut self.done);
    }

    /// Hands on everything: nothing more will come. What the board has not confirmed is spoilt.
    pub fn finish(&mut self) {
        if let (Some(confirmed), Some(next)) = (self.confirmed.take(), self.next) {
            // Whether all notices have arrived, nothing tells any more: a lost one leaves no hole.
            for axis in 0..AXES {
                self.spoil_range(axis, confirmed..next);
            }
        }
        self.held.release(u64::MAX, &mut self.done);
    }

    /// Samples before the returned index can be handed on.
    fn certain(&self) -> u64 {
        let next = self.next_index();
        self.confirmed
            .map_or(next.saturating_sub(HELD), |confirmed| {
                confirmed.max(next.saturating_sub(LONGEST_HELD))
            })
    }

    /// A notice about these axes was lost, since the last confirmation.
    pub fn miss_notice(&mut self, unheard: [bool; AXES]) {
        for axis in (0..AXES).filter(|&axis| unheard[axis]) {
            self.spoil_range(axis, self.confirmed.unwrap_or(0)..self.next_index());
        }
    }

    /// Every notice up to conversion `index` of `stream` has arrived, or is known to be missing. If
    /// the board has also proved its words up to there, `to_the_end`, nothing more will be said
    /// about them.
    pub fn confirm(&mut self, stream: u16, index: u64, to_the_end: bool) {
        if self.streams.is_another(stream) {
            return;
        }
        let index = self.streams.place(index).min(self.next_index());
        let late = if to_the_end { 0 } else { SLIP_NOTICE };
        self.confirmed = Some(index.saturating_sub(late));
    }

    /// A fault was told of: the `words` before it must not be used.
    pub fn spoil(&mut self, axis: u8, event: &Event, words: u64) {
        let axis = usize::from(axis);
        if self.streams.is_another(event.stream) {
            let range = event.index.saturating_sub(words)..event.index;
            return self.ahead.spoil(event.stream, axis, range);
        }
        let index = self.streams.place(event.index);
        self.spoil_range(axis, index.saturating_sub(words)..index);
    }

    fn spoil_range(&mut self, axis: usize, range: Range<u64>) {
        if let Some(suspect) = self.spoilt.suspect(axis, range) {
            self.held.mark_suspect(axis, suspect);
        }
    }

    /// What comes next may be of a new stream.
    pub fn announce(&mut self) {
        self.streams.announce();
    }

    /// Whether a batch is one of the present stream that was there already, or comes too late, be it
    /// of the stream before. It is left out, and counted.
    pub fn leaves_out(&mut self, batch: &Batch) -> bool {
        let left_out = self.streams.hold(batch, self.is_later(batch));
        self.losses.left_out += u64::from(left_out);
        left_out
    }

    /// Whether a batch goes on with the count, be it after a gap.
    pub fn is_later(&self, batch: &Batch) -> bool {
        let place = self.streams.place(batch.first);
        !self.streams.is_another(batch.stream) && self.next.is_none_or(|next| place >= next)
    }

    /// The next batch, if a gap is ahead of it, has this one for a cause.
    pub fn explain(&mut self, cause: String) {
        self.cause = Some(cause);
    }

    /// The first gaps of unknown length.
    pub fn unknown_gaps(&self) -> &[Gap] {
        &self.unknown
    }

    /// The next finished chunk.
    pub fn pop(&mut self) -> Option<Chunk> {
        self.done.pop_front()
    }

    /// News of the stream, in its place among the samples.
    pub fn news(&mut self, text: String) {
        self.done.push_back(Chunk::News(text));
    }

    /// What was lost so far.
    pub fn losses(&self) -> Losses {
        self.losses
    }

    /// What leads from the board's index to that of the record.
    pub(super) fn offset(&self) -> u64 {
        self.streams.offset()
    }

    /// Index that the next sample should have: the number of samples, lost ones included.
    pub fn next_index(&self) -> u64 {
        self.next.unwrap_or(0)
    }

    fn gap(&mut self, from: u64, to: Option<u64>, cause: String) {
        if to.is_none() {
            // The count begins anew: no notice will name what was before.
            self.finish();
        }
        self.losses.gaps += 1;
        let cause = self.cause.take().unwrap_or(cause);
        let gap = Gap { from, to, cause };
        if to.is_none() && self.unknown.len() < LISTED {
            self.unknown.push(gap.clone());
        }
        self.held.gap(gap);
    }

    fn append(&mut self, first: u64, batch: &Batch) {
        let block = self.held.growing(first);
        let start = block.len();
        for codes in &batch.codes {
            for (column, code) in block.codes.iter_mut().zip(codes) {
                column.push(code.0);
            }
        }
        self.spoilt.mark(block, start, batch, &mut self.losses);
    }
}

#[cfg(test)]
mod tests;
