//! What arrives at the host, what it makes of it, and whether that is right.

use std::collections::HashMap;

use inm_host::internals::source::frames::Frames;
use inm_host::internals::source::{Block, Chunk, Values};
use inm_protocol::{AXES, Batch, Decoder, ToHost};

use super::channel::Channel;
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

/// Samples at the end of a record among which one of each axis has to be right: two batches.
const AT_THE_END: u64 = 64;

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
    /// Every axis has a right sample among its last ones.
    pub recovered: bool,
    /// The wrong ones.
    pub wrong: Vec<Wrong>,
}

/// The host's end.
pub(super) struct Judge {
    channel: Channel,
    sound: bool,
    frames: Frames,
    /// What has arrived, as it did.
    arrived: Decoder,
    sent: u64,
    /// Stamps of the conversions, by stream and index.
    stamps: HashMap<(usize, u64), u64>,
    /// Stream of each batch, by its first index and its stamp.
    streams: HashMap<(u64, u64), usize>,
    /// Streams that the board has begun.
    begun: usize,
    /// By stream: index of the first conversion that arrived.
    arrived_first: HashMap<usize, u64>,
    outcome: Outcome,
}

impl Judge {
    pub fn new(plan: &Plan, dice: Dice) -> Self {
        Self {
            channel: Channel::new(plan.link, dice),
            sound: false,
            frames: Frames::default(),
            arrived: Decoder::new(),
            sent: 0,
            stamps: HashMap::new(),
            streams: HashMap::new(),
            begun: 0,
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
        self.sent += 1;
        match message {
            ToHost::Samples(batch) => self.batch(batch, period),
            ToHost::Event(event) => {
                self.outcome.resets += u64::from(event.trouble.is_reset_for());
            }
            _ => {}
        }
        if !heard {
            return;
        }
        if self.sound {
            return self.arrive(frame);
        }
        if matches!(message, ToHost::Reply(_)) {
            // Whoever asks waits for the reply: nothing of the stream before is still on its way.
            let rest = self.channel.rest();
            self.arrive(&rest);
        }
        let arrived = self.channel.pass(frame);
        self.arrive(&arrived);
    }

    fn batch(&mut self, batch: &Batch, period: u64) {
        self.begun += usize::from(batch.seq == 0);
        self.streams.insert((batch.first, batch.stamp), self.begun);
        for index in batch.first..batch.end() {
            let stamp = batch.stamp + (index - batch.first) * period;
            self.stamps.insert((self.begun, index), stamp);
        }
    }

    fn arrive(&mut self, bytes: &[u8]) {
        let mut left = bytes;
        while let Some(message) = self.arrived.next::<ToHost>(&mut left) {
            if let Ok(ToHost::Samples(batch)) = message {
                let stream = self.streams[&(batch.first, batch.stamp)];
                self.arrived_first.entry(stream).or_insert(batch.first);
            }
        }
        self.frames.push(bytes);
        self.frames.flush();
    }

    /// Compares what the host made of it with the words that the converters `made`.
    pub fn verdict(mut self, made: &HashMap<(usize, u64), u32>) -> Outcome {
        let rest = self.channel.rest();
        self.arrive(&rest);
        self.frames.finish();
        self.outcome.lost_frames = self.sent.saturating_sub(self.arrived.counts().frames);
        let end = self.frames.next_index();
        let mut last_right = [None; AXES];
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
                    for (axis, last_right) in last_right.iter_mut().enumerate() {
                        let truth = |index: u64| {
                            let on_board = (index as i64 + offset) as u64;
                            let stamp = self.stamps.get(&(stream, on_board));
                            stamp.and_then(|&stamp| made.get(&(axis, stamp)).copied())
                        };
                        *last_right = compare(&block, axis, truth, outcome).or(*last_right);
                    }
                }
            }
        }
        outcome.recovered = last_right
            .iter()
            .all(|right| right.is_some_and(|right| right + AT_THE_END >= end));
        self.outcome
    }
}

/// Compares the samples of one axis with what its converter made; the last right one, if there is one.
fn compare(
    block: &Block,
    axis: usize,
    truth: impl Fn(u64) -> Option<u32>,
    outcome: &mut Outcome,
) -> Option<u64> {
    let column = &block.columns[axis];
    let Values::Codes(codes) = &column.values else {
        panic!("a board sends codes");
    };
    let mut last_right = None;
    for (k, &code) in codes.iter().enumerate() {
        let index = block.first + k as u64;
        let made = truth(index);
        let right = made == Some(code as u32);
        let marked = column.invalid.iter().any(|bad| bad.contains(&k));
        outcome.marked += u64::from(marked);
        outcome.given_up += u64::from(marked && right);
        match (marked, right) {
            (true, _) => {}
            (false, true) => {
                outcome.right += 1;
                last_right = Some(index);
            }
            (false, false) => outcome.wrong.push(Wrong {
                index,
                axis,
                code,
                made,
            }),
        }
    }
    last_right
}
