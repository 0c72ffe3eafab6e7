//! Batches into blocks: continuity, loss, and words that must not be used.

mod ahead;
mod building;
mod held;
mod losses;
mod ranges;

use std::collections::VecDeque;
use std::ops::Range;

use inm_protocol::{AXES, Batch, Event, Flags};

use self::ahead::Ahead;
use self::held::Held;
use self::ranges::mark;
use super::line::Line;
use super::{Chunk, Gap};

pub use self::losses::Losses;

/// Samples ahead of a clipped word that its filter ringing reaches (linear phase).
const GUARD_BEFORE: u64 = 31;

/// Samples after a clipped word until the converter is clean again (SBAS378D, page 12).
const GUARD_AFTER: u64 = 62;

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
/// Words near a clipped one are marked too, `GUARD_BEFORE` and `GUARD_AFTER`, and those ahead
/// of the notice of a fault. To be able to mark backwards, samples wait for what is still to be
/// said about them, across gaps: until the board has [confirmed](Self::confirm) that every notice
/// has arrived, or [`HELD`] of them.
#[derive(Debug, Default)]
pub struct Assembler {
    held: Held,
    /// Nothing more will be said about samples before this index; `None` where the board does not
    /// tell.
    confirmed: Option<u64>,
    /// Added to the board's index, so that the count goes on after a restart.
    offset: u64,
    seq: Option<u32>,
    /// The present stream.
    line: Option<Line>,
    /// The one before, if it had another number.
    former: Option<Line>,
    /// What was told of a stream of which nothing else has arrived.
    ahead: Ahead,
    /// First index and stamp of the present stretch without a gap, in the board's own count.
    begun: (u64, u64),
    /// Conversions and ticks of the longest such stretch so far.
    longest: (u64, u64),
    /// Index that should come next, offset included.
    next: Option<u64>,
    /// By axis: samples before this index follow a clipped word.
    ringing_until: [u64; AXES],
    /// By axis: samples that a fault was noticed to have spoilt.
    suspect: [Range<u64>; AXES],
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
        self.measure(batch, self.next == Some(first));
        self.cause = None;
        match &mut self.line {
            Some(line) => line.extend(batch),
            None => self.begin(first, batch),
        }
        self.seq = Some(batch.seq);
        self.next = Some(first + batch.codes.len() as u64);
        self.append(first, batch);
        let until = self.certain();
        if self
            .held
            .oldest()
            .is_some_and(|oldest| until.saturating_sub(oldest) >= BLOCK)
        {
            self.held.release(until, &mut self.done);
        }
    }

    /// Conversions and ticks from the first batch to the last of the longest stretch without a gap: over
    /// one, converters may have been synchronised anew.
    pub fn longest_stretch(&self) -> (u64, u64) {
        self.longest
    }

    fn measure(&mut self, batch: &Batch, goes_on: bool) {
        if !goes_on {
            self.begun = (batch.first, batch.stamp);
        }
        let ticks = batch.stamp.saturating_sub(self.begun.1);
        if ticks > self.longest.1 {
            self.longest = (batch.first.saturating_sub(self.begun.0), ticks);
        }
    }

    /// A stream begins with this batch, sample `first` of the record.
    fn begin(&mut self, first: u64, batch: &Batch) {
        self.line = Some(Line::new(batch));
        if batch.stream != 0 {
            // Every board that numbers its streams confirms them.
            self.confirmed.get_or_insert(first);
        }
        for (axis, range) in self.ahead.take(batch).into_iter().enumerate() {
            let [from, to] = [range.start, range.end].map(|at| at.wrapping_add(self.offset));
            self.spoil_range(axis, from..to);
        }
    }

    /// Index of a batch in the record, once the gap ahead of it is told.
    fn place(&mut self, batch: &Batch) -> u64 {
        let mut first = batch.first.wrapping_add(self.offset);
        let lost_batches = self
            .seq
            .map_or(0, |seq| batch.seq.wrapping_sub(seq.wrapping_add(1)));
        match self.next {
            None if first > LONGEST_GAP => first = self.anew(batch, 0),
            Some(next) if first < next || self.is_of_another(batch.stream) => {
                // The board has counted from 0 again: how much time passed is not known.
                first = self.anew(batch, next + 1);
                self.losses.restarts += 1;
                self.gap(
                    next,
                    None,
                    "the board started again from index 0".to_owned(),
                );
            }
            Some(next) if first - next > LONGEST_GAP => {
                let jump = first - next;
                first = self.anew(batch, next + 1);
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
        if self.is_of_another(stream) {
            return;
        }
        let index = index.wrapping_add(self.offset).min(self.next_index());
        let late = if to_the_end { 0 } else { SLIP_NOTICE };
        self.confirmed = Some(index.saturating_sub(late));
    }

    /// A fault was told of: the `words` before it must not be used.
    pub fn spoil(&mut self, axis: u8, event: &Event, words: u64) {
        let axis = usize::from(axis);
        if self.is_of_another(event.stream) {
            let range = event.index.saturating_sub(words)..event.index;
            return self.ahead.spoil(event.stream, axis, range);
        }
        let index = event.index.wrapping_add(self.offset);
        self.spoil_range(axis, index.saturating_sub(words)..index);
    }

    fn spoil_range(&mut self, axis: usize, range: Range<u64>) {
        if let Some(suspect) = self.suspect.get_mut(axis) {
            *suspect = range;
            self.held.mark_suspect(axis, suspect);
        }
    }

    /// Has the record go on with this batch as sample `first`, and returns that.
    fn anew(&mut self, batch: &Batch, first: u64) -> u64 {
        self.offset = first.wrapping_sub(batch.first);
        let before = self.line.take();
        let other = before.filter(|line| !line.is_of(batch.stream));
        self.former = other.map(Line::over).or(self.former);
        first
    }

    /// Whether what says that it is of `stream` is of another than the present one.
    fn is_of_another(&self, stream: u16) -> bool {
        self.line.is_some_and(|line| !line.is_of(stream))
    }

    /// What comes next may be of a new stream.
    pub fn announce(&mut self) {
        if let Some(line) = &mut self.line {
            line.announce();
        }
    }

    /// Whether a batch is one of the present stream that was there already, or comes too late, be it
    /// of the stream before. It is left out, and counted.
    pub fn leaves_out(&mut self, batch: &Batch) -> bool {
        let holds = |line: Option<Line>| line.is_some_and(|line| line.holds(batch));
        let left_out = holds(self.former) || (holds(self.line) && !self.is_later(batch));
        self.losses.left_out += u64::from(left_out);
        left_out
    }

    /// Whether a batch goes on with the count, be it after a gap.
    pub fn is_later(&self, batch: &Batch) -> bool {
        let place = batch.first.wrapping_add(self.offset);
        !self.is_of_another(batch.stream) && self.next.is_none_or(|next| place >= next)
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
        self.offset
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
        let end = block.len();
        for (invalid, &until) in block.invalid.iter_mut().zip(&self.ringing_until) {
            mark(
                invalid,
                start..end.min(until.saturating_sub(block.first) as usize),
            );
        }
        for (axis, suspect) in self.suspect.iter().enumerate() {
            block.mark_suspect(axis, suspect);
        }
        for flag in &batch.flags {
            let axis = usize::from(flag.axis);
            let at = start + usize::from(flag.conversion);
            // Numbers from the wire: an impossible place is ignored, the frame was intact.
            let Some(invalid) = block.invalid.get_mut(axis).filter(|_| at < end) else {
                continue;
            };
            self.losses.flagged[axis] += 1;
            if flag.flags.has(Flags::OVER_RANGE) {
                let ahead = at.saturating_sub(GUARD_BEFORE as usize);
                mark(invalid, ahead..end.min(at + 1 + GUARD_AFTER as usize));
                self.ringing_until[axis] = block.first + at as u64 + 1 + GUARD_AFTER;
            } else {
                mark(invalid, at..at + 1);
            }
        }
    }
}

#[cfg(test)]
mod tests;
