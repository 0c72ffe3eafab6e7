//! Conversions gathered into batches.

use inm_protocol::{AXES, Batch, Code, Flag, Flags};

/// One conversion of all axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Conversion {
    /// Data periods since the start command.
    pub index: u64,
    /// Timer at DRDY, ticks.
    pub stamp: u64,
    /// Words of X, Y, Z.
    pub codes: [Code; AXES],
    /// What is wrong with them.
    pub flags: [Flags; AXES],
}

/// The batch being filled.
#[derive(Debug, Default)]
pub(super) struct Batcher {
    batch: Batch,
    /// Sequence number of the batch after this one.
    next: u32,
    /// What all of them are of.
    stream: u16,
}

impl Batcher {
    /// Adds a conversion, which must follow the last one added without a gap; returns the
    /// batch if that filled it.
    pub(super) fn push(&mut self, conversion: &Conversion) -> Option<Batch> {
        let batch = &mut self.batch;
        if batch.codes.is_empty() {
            batch.first = conversion.index;
            batch.stamp = conversion.stamp;
        }
        let place = batch.codes.len() as u8;
        // Neither push can fail: a full batch is taken at once, and the flags have room for
        // every word.
        let _ = batch.codes.push(conversion.codes);
        for (axis, &flags) in (0..).zip(&conversion.flags) {
            if !flags.is_none() {
                let _ = batch.flags.push(Flag {
                    conversion: place,
                    axis,
                    flags,
                });
            }
        }
        if batch.codes.is_full() {
            self.take()
        } else {
            None
        }
    }

    /// Conversions in the batch.
    pub(super) fn len(&self) -> usize {
        self.batch.codes.len()
    }

    /// The batch as far as it is filled; `None` if it is empty.
    pub(super) fn take(&mut self) -> Option<Batch> {
        if self.batch.codes.is_empty() {
            return None;
        }
        let mut batch = core::mem::take(&mut self.batch);
        batch.seq = self.next;
        batch.stream = self.stream;
        self.next = self.next.wrapping_add(1);
        Some(batch)
    }

    /// Starts a new stream: nothing gathered, sequence number 0.
    pub(super) fn restart(&mut self, stream: u16) {
        *self = Self {
            stream,
            ..Self::default()
        };
    }
}
