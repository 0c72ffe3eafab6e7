//! What arrives at the host, what it makes of it, and whether that is right.

use std::collections::HashMap;

use inm_host::internals::source::frames::Frames;
use inm_host::internals::source::{Chunk, Values};
use inm_protocol::{AXES, Batch, ToHost};

use super::{Dice, Plan};

/// A sample that the host took for good and that is not the converter's word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wrong {
    /// Index in the record.
    pub index: u64,
    /// Axis, 0 to 2.
    pub axis: usize,
    /// What the host has, as it came over the link.
    pub code: i32,
    /// What the converter made; `None` where it made nothing at that moment.
    pub made: Option<u32>,
}

/// How a run came out.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// Samples, axis by axis, that the host took for good and that are.
    pub right: u64,
    /// Samples that the host has marked as not to be used.
    pub marked: u64,
    /// Of these, those that are right, and were given up for safety.
    pub given_up: u64,
    /// Samples missing in gaps of known length.
    pub missing: u64,
    /// Frames that did not arrive intact.
    pub lost_frames: u64,
    /// Notices of axes that were reset.
    pub resets: u64,
    /// The wrong ones.
    pub wrong: Vec<Wrong>,
}

/// The host's end.
pub(super) struct Judge {
    dice: Dice,
    loss: Option<u64>,
    sound: bool,
    frames: Frames,
    /// Stamps of the conversions, by stream and index.
    stamps: HashMap<(usize, u64), u64>,
    /// Streams that the board has begun.
    streams: usize,
    /// By stream: index of the first conversion that arrived.
    arrived_first: HashMap<usize, u64>,
    outcome: Outcome,
}

impl Judge {
    pub fn new(plan: &Plan, dice: Dice) -> Self {
        Self {
            dice,
            loss: plan.loss,
            sound: false,
            frames: Frames::default(),
            stamps: HashMap::new(),
            streams: 0,
            arrived_first: HashMap::new(),
            outcome: Outcome::default(),
        }
    }

    /// Whether the link is sound, whatever the plan says: what begins a record has to arrive.
    pub fn sound(&mut self, sound: bool) {
        self.sound = sound;
    }

    /// A frame that the board has sent; `period` in ticks of its timer.
    pub fn frame(&mut self, frame: &[u8], message: &ToHost, period: u64, heard: bool) {
        let loss = self.loss.filter(|_| !self.sound);
        let lost = loss.is_some_and(|one_in| self.dice.one_in(one_in));
        let damaged = loss.is_some_and(|one_in| self.dice.one_in(one_in));
        let intact = heard && !lost && !damaged;
        self.outcome.lost_frames += u64::from(!intact);
        match message {
            ToHost::Samples(batch) => self.batch(batch, period, intact),
            ToHost::Event(event) => {
                self.outcome.resets += u64::from(event.trouble.is_reset_for());
            }
            _ => {}
        }
        if intact {
            self.frames.push(frame);
        } else if heard && !lost {
            let mut frame = frame.to_vec();
            let at = self.dice.below(frame.len() as u64 - 1) as usize;
            frame[at] ^= if frame[at] == 1 { 2 } else { 1 };
            self.frames.push(&frame);
        }
        self.frames.flush();
    }

    fn batch(&mut self, batch: &Batch, period: u64, intact: bool) {
        self.streams += usize::from(batch.seq == 0);
        for index in batch.first..batch.end() {
            let stamp = batch.stamp + (index - batch.first) * period;
            self.stamps.insert((self.streams, index), stamp);
        }
        if intact {
            self.arrived_first
                .entry(self.streams)
                .or_insert(batch.first);
        }
    }

    /// Compares what the host made of it with the words that the converters `made`.
    pub fn verdict(mut self, made: &HashMap<(usize, u64), u32>) -> Outcome {
        self.frames.finish();
        let mut streams: Vec<(usize, u64)> = self.arrived_first.into_iter().collect();
        streams.sort_unstable();
        let mut streams = streams.into_iter();
        // Number of the stream, and its index less that of the record.
        let mut place = streams.next().map(|(stream, _)| (stream, 0_i64));
        let outcome = &mut self.outcome;
        while let Some(chunk) = self.frames.pop() {
            match chunk {
                Chunk::News(_) => {}
                Chunk::Gap(gap) => match gap.to {
                    Some(to) => outcome.missing += to - gap.from,
                    None => {
                        let next = streams.next();
                        place = next
                            .map(|(stream, first)| (stream, first as i64 - (gap.from as i64 + 1)));
                    }
                },
                Chunk::Samples(block) => {
                    let (stream, offset) = place.expect("samples are of a stream");
                    for axis in 0..AXES {
                        let column = &block.columns[axis];
                        let Values::Codes(codes) = &column.values else {
                            panic!("a board sends codes");
                        };
                        for (k, &code) in codes.iter().enumerate() {
                            let index = block.first + k as u64;
                            let on_board = (index as i64 + offset) as u64;
                            let stamp = self.stamps.get(&(stream, on_board));
                            let made = stamp.and_then(|&stamp| made.get(&(axis, stamp)).copied());
                            let right = made == Some(code as u32);
                            let marked = column.invalid.iter().any(|bad| bad.contains(&k));
                            outcome.marked += u64::from(marked);
                            outcome.given_up += u64::from(marked && right);
                            outcome.right += u64::from(!marked && right);
                            if !marked && !right {
                                outcome.wrong.push(Wrong {
                                    index,
                                    axis,
                                    code,
                                    made,
                                });
                            }
                        }
                    }
                }
            }
        }
        self.outcome
    }
}
