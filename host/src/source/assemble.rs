//! Batches into blocks: continuity, loss, and words that must not be used.

use std::collections::VecDeque;
use std::ops::Range;

use inm_protocol::{AXES, Batch, Flags};

use super::{Block, Chunk, Column, Gap, Values};

/// Samples ahead of a clipped word that its filter ringing reaches (linear phase).
const GUARD_BEFORE: u64 = 31;

/// Samples after a clipped word until the converter is clean again (SBAS378D, page 12).
const GUARD_AFTER: u64 = 62;

/// Samples that are held until it is known that nothing further will be said about them: a
/// slipped bit under much noise is noticed up to 530 conversions late
/// (docs/reference/board-faults.md).
pub const HELD: usize = 640;

/// Samples an axis after which a block is handed on.
const BLOCK: usize = 4096;

/// What the stream lost, and what it flagged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Losses {
    /// Samples an axis that are missing between the first and the last.
    pub lost_samples: u64,
    /// Places where samples are missing.
    pub gaps: u64,
    /// Batches that the board filled and the host did not receive intact.
    pub lost_batches: u64,
    /// Words flagged by the board, by axis.
    pub flagged: [u64; AXES],
    /// Times the board began again from index 0.
    pub restarts: u64,
}

/// Puts batches together into long blocks and reports every hole between them.
///
/// Words near a clipped one are marked too, `GUARD_BEFORE` and `GUARD_AFTER`, and those ahead
/// of the notice of a fault. To be able to mark backwards, [`HELD`] samples wait for what is
/// still to be said about them.
#[derive(Debug, Default)]
pub struct Assembler {
    /// Block under construction.
    block: Option<Building>,
    /// Added to the board's index, so that the count goes on after a restart.
    offset: u64,
    seq: Option<u32>,
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

#[derive(Debug)]
struct Building {
    first: u64,
    codes: [Vec<i32>; AXES],
    invalid: [Vec<Range<usize>>; AXES],
}

impl Assembler {
    /// Takes the next batch that arrived intact.
    pub fn push(&mut self, batch: &Batch) {
        let mut first = batch.first.wrapping_add(self.offset);
        let lost_batches = self
            .seq
            .map_or(0, |seq| batch.seq.wrapping_sub(seq.wrapping_add(1)));
        match self.next {
            Some(next) if first < next => {
                // The board counts from 0 again: how much time passed is not known.
                self.offset = next + 1 - batch.first.min(next);
                first = batch.first + self.offset;
                self.losses.restarts += 1;
                self.gap(
                    next,
                    None,
                    "the board started again from index 0".to_owned(),
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
        self.cause = None;
        self.seq = Some(batch.seq);
        self.next = Some(first + batch.codes.len() as u64);
        self.append(first, batch);
        if self
            .block
            .as_ref()
            .is_some_and(|block| block.len() >= BLOCK + HELD)
        {
            self.hand_on(HELD);
        }
    }

    /// Hands on what is complete, without waiting for a long block.
    pub fn flush(&mut self) {
        self.hand_on(HELD);
    }

    /// Hands on everything: nothing more will come.
    pub fn finish(&mut self) {
        self.hand_on(0);
    }

    /// A fault of `axis` was noticed at the board's conversion `index`: the `words` before it
    /// must not be used.
    pub fn spoil(&mut self, axis: u8, index: u64, words: u64) {
        let Some(suspect) = self.suspect.get_mut(usize::from(axis)) else {
            return;
        };
        let index = index.wrapping_add(self.offset);
        *suspect = index.saturating_sub(words)..index;
        if let Some(block) = &mut self.block {
            block.mark_suspect(usize::from(axis), suspect);
        }
    }

    /// Whether a batch goes on with the count, be it after a gap.
    pub fn is_later(&self, batch: &Batch) -> bool {
        self.next
            .is_none_or(|next| batch.first.wrapping_add(self.offset) >= next)
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
        self.hand_on(0);
        self.losses.gaps += 1;
        let cause = self.cause.take().unwrap_or(cause);
        let gap = Gap { from, to, cause };
        if to.is_none() && self.unknown.len() < LISTED {
            self.unknown.push(gap.clone());
        }
        self.done.push_back(Chunk::Gap(gap));
    }

    fn append(&mut self, first: u64, batch: &Batch) {
        let block = self.block.get_or_insert_with(|| Building {
            first,
            codes: Default::default(),
            invalid: Default::default(),
        });
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

    /// Finishes the block under construction except for its last `keep` samples.
    fn hand_on(&mut self, keep: usize) {
        let Some(block) = &mut self.block else { return };
        let len = block.len().saturating_sub(keep);
        if len == 0 {
            if keep == 0 {
                self.block = None;
            }
            return;
        }
        let first = block.first;
        let columns = block
            .codes
            .iter_mut()
            .zip(&mut block.invalid)
            .map(|(codes, invalid)| {
                let tail = codes.split_off(len);
                let values = Values::Codes(std::mem::replace(codes, tail));
                Column {
                    values,
                    invalid: split_ranges(invalid, len),
                }
            })
            .collect();
        block.first += len as u64;
        if block.len() == 0 {
            self.block = None;
        }
        self.done
            .push_back(Chunk::Samples(Block { first, columns }));
    }
}

impl Building {
    fn len(&self) -> usize {
        self.codes[0].len()
    }

    /// Marks what of `suspect` (in samples of the record) lies in this block.
    fn mark_suspect(&mut self, axis: usize, suspect: &Range<u64>) {
        let len = self.len() as u64;
        let place = |index: u64| index.saturating_sub(self.first).min(len) as usize;
        mark(
            &mut self.invalid[axis],
            place(suspect.start)..place(suspect.end),
        );
    }
}

/// Adds `range` to ascending disjoint ranges; it may overlap any of them.
fn mark(ranges: &mut Vec<Range<usize>>, range: Range<usize>) {
    if range.is_empty() {
        return;
    }
    let mut merged = range;
    let from = ranges.partition_point(|r| r.end < merged.start);
    let to = ranges.partition_point(|r| r.start <= merged.end);
    if let Some(overlap) = ranges.get(from..to).filter(|r| !r.is_empty()) {
        merged.start = merged.start.min(overlap[0].start);
        merged.end = merged.end.max(overlap[overlap.len() - 1].end);
    }
    ranges.splice(from..to, [merged]);
}

/// Takes what lies before `at` out of `ranges`; the rest is renumbered from there.
fn split_ranges(ranges: &mut Vec<Range<usize>>, at: usize) -> Vec<Range<usize>> {
    let before = ranges
        .iter()
        .filter(|r| r.start < at)
        .map(|r| r.start..r.end.min(at))
        .collect();
    let after = ranges
        .iter()
        .filter(|r| r.end > at)
        .map(|r| r.start.max(at) - at..r.end - at)
        .collect();
    *ranges = after;
    before
}

#[cfg(test)]
mod tests {
    use inm_protocol::{Code, Flag};

    use super::*;

    fn batch(seq: u32, first: u64, len: usize) -> Batch {
        let codes = (0..len)
            .map(|i| [Code((first as usize + i) as i32); AXES])
            .collect();
        Batch {
            seq,
            first,
            codes,
            ..Batch::default()
        }
    }

    fn run(batches: &[Batch]) -> (Vec<Chunk>, Losses) {
        let mut assembler = Assembler::default();
        for batch in batches {
            assembler.push(batch);
            assembler.flush();
        }
        assembler.finish();
        let chunks = std::iter::from_fn(|| assembler.pop()).collect();
        (chunks, assembler.losses())
    }

    fn codes(chunk: &Chunk) -> (u64, Vec<i32>) {
        match chunk {
            Chunk::Samples(block) => match &block.columns[0].values {
                Values::Codes(codes) => (block.first, codes.clone()),
                Values::Floats(_) => panic!("codes stay codes"),
            },
            other => panic!("samples expected, got {other:?}"),
        }
    }

    #[test]
    fn contiguous_batches_lose_nothing() {
        let (chunks, losses) = run(&[batch(0, 0, 32), batch(1, 32, 32), batch(2, 64, 7)]);
        let all: Vec<i32> = chunks.iter().flat_map(|c| codes(c).1).collect();
        assert_eq!(all, (0..71).collect::<Vec<_>>());
        assert_eq!(losses, Losses::default());
    }

    #[test]
    fn a_lost_batch_is_a_gap_of_its_length() {
        let (chunks, losses) = run(&[batch(0, 0, 32), batch(2, 64, 32)]);
        let gap = Gap {
            from: 32,
            to: Some(64),
            cause: "1 batch was lost on the link".into(),
        };
        assert!(chunks.contains(&Chunk::Gap(gap)), "{chunks:?}");
        assert_eq!(
            (losses.lost_samples, losses.lost_batches, losses.gaps),
            (32, 1, 1)
        );
        assert_eq!(codes(chunks.last().expect("samples after the gap")).0, 64);
    }

    #[test]
    fn a_restart_of_the_count_is_a_gap_of_unknown_length() {
        let (chunks, losses) = run(&[batch(0, 0, 32), batch(0, 0, 32)]);
        assert!(
            matches!(
                &chunks[1],
                Chunk::Gap(Gap {
                    from: 32,
                    to: None,
                    ..
                })
            ),
            "{chunks:?}"
        );
        assert_eq!(
            codes(&chunks[2]).0,
            33,
            "the count goes on, one place left open"
        );
        assert_eq!(losses.restarts, 1);
    }

    #[test]
    fn a_clipped_word_is_marked_with_what_rings_around_it() {
        let mut clipped = batch(1, 32, 32);
        let flag = Flag {
            conversion: 2,
            axis: 1,
            flags: Flags::OVER_RANGE,
        };
        clipped.flags.push(flag).expect("room");
        let (chunks, losses) = run(&[batch(0, 0, 32), clipped, batch(2, 64, 32), batch(3, 96, 32)]);
        let mut marked: Vec<u64> = Vec::new();
        for chunk in &chunks {
            if let Chunk::Samples(block) = chunk {
                assert!(block.columns[0].invalid.is_empty());
                let ranges = block.columns[1].invalid.iter().cloned().flatten();
                marked.extend(ranges.map(|i| block.first + i as u64));
            }
        }
        assert_eq!(marked, (34 - 31..=34 + 62).collect::<Vec<u64>>());
        assert_eq!(losses.flagged, [0, 1, 0]);
    }

    #[test]
    fn a_fault_spoils_what_came_before_its_notice() {
        let mut assembler = Assembler::default();
        for seq in 0..40 {
            assembler.push(&batch(seq, 32 * u64::from(seq), 32));
            assembler.flush();
            if seq == 30 {
                // The notice overtakes the batch that holds its conversion.
                assembler.spoil(2, 1000, 500);
            }
        }
        assembler.finish();
        let mut spoilt = Vec::new();
        while let Some(Chunk::Samples(block)) = assembler.pop() {
            assert_eq!(block.columns[0].invalid, []);
            let ranges = block.columns[2].invalid.iter().cloned().flatten();
            spoilt.extend(ranges.map(|i| block.first + i as u64));
        }
        assert_eq!(spoilt, (500..1000).collect::<Vec<u64>>());
    }

    #[test]
    fn marks_merge_and_split() {
        let mut ranges = vec![0..2, 5..6, 9..12];
        mark(&mut ranges, 2..5);
        assert_eq!(ranges, [0..6, 9..12]);
        mark(&mut ranges, 7..8);
        assert_eq!(ranges, [0..6, 7..8, 9..12]);
        assert_eq!(split_ranges(&mut ranges, 10), [0..6, 7..8, 9..10]);
        assert_eq!(ranges, [0..2]);
    }
}
