//! The way of a frame from the board to the host, and what happens to it there.

use std::collections::VecDeque;

use super::Dice;

/// What the link does to frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// Nothing.
    Sound,
    /// One frame in so many is lost, and in one of as many a byte is wrong.
    Lossy(u64),
    /// One byte in so many has a flipped bit, is missing, or has another one ahead of it.
    Dirty(u64),
    /// One frame in so many comes once more, later; one in as many changes places with one of the next.
    OutOfPlace(u64),
}

/// Frames that one may be late by, or come once more after.
const REACH: u64 = 6;

/// A link and what it holds back.
pub(super) struct Channel {
    link: Link,
    dice: Dice,
    /// Frames that come later: after so many others.
    late: VecDeque<(u64, Vec<u8>)>,
}

impl Channel {
    pub fn new(link: Link, dice: Dice) -> Self {
        Self {
            link,
            dice,
            late: VecDeque::new(),
        }
    }

    /// What arrives at the host once the board has sent this frame.
    pub fn pass(&mut self, frame: &[u8]) -> Vec<u8> {
        match self.link {
            Link::Sound => frame.to_vec(),
            Link::Lossy(one_in) => self.lose(frame, one_in),
            Link::Dirty(one_in) => self.soil(frame, one_in),
            Link::OutOfPlace(one_in) => self.displace(frame, one_in),
        }
    }

    /// What is still on its way.
    pub fn rest(&mut self) -> Vec<u8> {
        self.late.drain(..).flat_map(|(_, frame)| frame).collect()
    }

    fn lose(&mut self, frame: &[u8], one_in: u64) -> Vec<u8> {
        let mut frame = frame.to_vec();
        if self.dice.one_in(one_in) {
            frame.clear();
        } else if self.dice.one_in(one_in) {
            let at = self.dice.below(frame.len() as u64 - 1) as usize;
            // Not to the zero that ends a frame.
            frame[at] ^= if frame[at] == 1 { 2 } else { 1 };
        }
        frame
    }

    fn soil(&mut self, frame: &[u8], one_in: u64) -> Vec<u8> {
        let mut arrived = Vec::new();
        for &byte in frame {
            if !self.dice.one_in(one_in) {
                arrived.push(byte);
                continue;
            }
            match self.dice.below(4) {
                0 => {}
                1 => arrived.extend([self.dice.word() as u8, byte]),
                _ => arrived.push(byte ^ 1 << self.dice.below(8)),
            }
        }
        arrived
    }

    fn displace(&mut self, frame: &[u8], one_in: u64) -> Vec<u8> {
        let mut arrived = Vec::new();
        for (after, _) in &mut self.late {
            *after -= 1;
        }
        if self.dice.one_in(one_in) {
            self.again(frame);
        } else {
            arrived.extend(frame);
            if self.dice.one_in(one_in) {
                self.again(frame);
            }
        }
        let due = |(after, _): &(u64, Vec<u8>)| *after == 0;
        arrived.extend(
            self.late
                .iter()
                .filter(|late| due(late))
                .flat_map(|(_, frame)| frame),
        );
        self.late.retain(|late| !due(late));
        arrived
    }

    /// Has this frame arrive behind some others.
    fn again(&mut self, frame: &[u8]) {
        let after = 1 + self.dice.below(REACH);
        self.late.push_back((after, frame.to_vec()));
    }
}
