//! One stream: its number, and where on the board's clock its conversions are, a straight line from index
//! to stamp. By these a batch that came before, or too late, is distinguished from the first of a new stream.

use inm_protocol::{BATCH_LEN, Batch};

/// Drift of the two clocks against each other that is let pass, as a fraction: quartz is ten times
/// better, and a board on its internal oscillator (1 %) is told apart by the reply to its start.
const DRIFT: f64 = 1e-4;

/// Data periods that a stamp may be off: an edge may be seen late.
const JITTER: f64 = 2.0;

/// Batches of which one at least arrives at the beginning of a stream: eight damaged frames in a row
/// are no accident.
const FIRST_FEW: u32 = 8;

/// First and last batch of a stream, index and stamp, in the board's own count.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// Which stream: number of the command that began it; 0 on a board that does not say.
    stream: u16,
    from: (u64, u64),
    to: (u64, u64),
    /// Number of the last batch.
    seq: u32,
    /// The board said that it starts another stream.
    ends: bool,
}

impl Line {
    /// A stream that begins with this batch.
    pub fn new(batch: &Batch) -> Self {
        let from = (batch.first, batch.stamp);
        Self {
            stream: batch.stream,
            from,
            to: from,
            seq: batch.seq,
            ends: false,
        }
    }

    /// The stream goes on with this batch.
    pub fn extend(&mut self, batch: &Batch) {
        self.to = (batch.first, batch.stamp);
        self.seq = batch.seq;
        self.ends = false;
    }

    /// Whether what says that it is of `stream` is of this one.
    pub fn is_of(&self, stream: u16) -> bool {
        self.stream == stream
    }

    /// The same once another stream has begun.
    pub fn over(self) -> Self {
        Self {
            ends: false,
            ..self
        }
    }

    /// What comes next may be of another stream.
    pub fn announce(&mut self) {
        self.ends = true;
    }

    /// Whether a batch may be one of those just ahead of the last: all that a single batch tells.
    fn is_just_behind(&self, batch: &Batch) -> bool {
        let numbers = u64::from(self.seq.wrapping_sub(batch.seq));
        let back = self.to.0.saturating_sub(batch.first);
        batch.seq < self.seq
            && batch.stamp < self.to.1
            && (1..=numbers * BATCH_LEN as u64).contains(&back)
    }

    /// Whether a batch that is not ahead of the stream is one of it. Of the same number is also what a
    /// board sends that was asked once more to start, and had lost its power since the first time.
    pub fn holds(&self, batch: &Batch) -> bool {
        if !self.is_of(batch.stream) || (self.ends && batch.seq < FIRST_FEW) {
            return false;
        }
        if self.to.0 == self.from.0 {
            return self.to == (batch.first, batch.stamp) || self.is_just_behind(batch);
        }
        let ticks = difference(self.to.1, self.from.1) / difference(self.to.0, self.from.0);
        let back = difference(self.to.0, batch.first);
        let off = difference(self.to.1, batch.stamp) - back * ticks;
        off.abs() <= (JITTER + back.abs() * DRIFT) * ticks
    }
}

/// `a - b` of numbers from the wire.
fn difference(a: u64, b: u64) -> f64 {
    a.wrapping_sub(b).cast_signed() as f64
}
