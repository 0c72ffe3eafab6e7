//! The two message types, one for each direction.

use heapless::String;
use serde::{Deserialize, Serialize};

use crate::{Batch, Command, Health, Message, Pulse, Reply};

/// Board to host.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
// A batch is the common case by far and there is no heap to box the rest into.
#[allow(clippy::large_enum_variant)]
pub enum ToHost {
    /// Samples.
    Samples(Batch),
    /// State of the board, once a second.
    Health(Health),
    /// Answer to a command.
    Reply(Reply),
    /// Something happened at a known conversion.
    Event(Event),
    /// Never sent by a board: the host writes it into a capture, between the frames received.
    Note(Note),
    /// A pulse a second came, where there is one.
    Pulse(Pulse),
}

/// Host to board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ToBoard {
    /// A request.
    Command(Command),
}

impl Message for ToHost {}

impl Message for ToBoard {}

/// Something happened on the board at a known conversion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Event {
    /// Conversion at which it was noticed, in the count of [`Batch::first`].
    pub index: u64,
    /// Axis, 0 to 2; `None` where it concerns all.
    pub axis: Option<u8>,
    /// What happened.
    pub trouble: Trouble,
    /// The stream that `index` counts in, as [`Batch::stream`].
    pub stream: u16,
}

/// What can go wrong on the board, and what it did about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[non_exhaustive]
pub enum Trouble {
    /// No DRDY edge for several data periods.
    Stalled,
    /// Every bit read was the same.
    Stuck {
        /// Which one.
        ones: bool,
    },
    /// The level jumped by a factor of two and stayed: a bit slipped.
    Slipped {
        /// Words came out doubled (a bit lost) rather than halved.
        doubled: bool,
    },
    /// The converter clipped.
    OverRange,
    /// The ID register is not that of an ADS1281.
    WrongId {
        /// What was read.
        found: u8,
    },
    /// A register differs from what was written; after a brown-out all are at their reset value.
    RegisterLost {
        /// Address, 00h to 0Ah.
        address: u8,
        /// What was written.
        wrote: u8,
        /// What was read.
        found: u8,
    },
    /// The SPI peripheral reported a fault.
    Bus,
    /// The transmit queue was full: batches were dropped, the host is slower than the link.
    LinkFull {
        /// Batches dropped in a row.
        batches: u32,
    },
    /// The converters run again after a reset and a new synchronisation.
    Recovered {
        /// Data periods without samples.
        lost: u32,
    },
    /// A register shows what no ADS1281 would, and the identity of the part is no help: it does not
    /// understand its commands, because a bit slipped on the way.
    Misaligned,
}

impl Trouble {
    /// Whether the axis is taken out of the stream for it and reset. Its words of the last
    /// [`UNPROVEN_PERIODS`] data periods must not be used then.
    pub const fn is_reset_for(self) -> bool {
        !matches!(
            self,
            Self::OverRange | Self::LinkFull { .. } | Self::Recovered { .. }
        )
    }
}

/// Longest time between two proofs that no bit of an axis has slipped, data periods: words from
/// before the notice of a fault may be wrong for as long. The board reads CONFIG0 of every axis
/// after 72, at the latest after 96, and has 32 left for three axes that are due at once, 8
/// conversions without an edge until that is a stall, and short gaps.
pub const UNPROVEN_PERIODS: u64 = 128;

/// Longest text of a mark, bytes: a sentence, and the frame is still shorter than a batch.
pub const MAX_MARK: usize = 120;

/// What the host saw of the link while recording, and what a person there marked.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Note {
    /// The port went away.
    PortLost {
        /// Wall clock, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
    },
    /// A port was opened again; whether the board streams is another note's.
    PortBack {
        /// Wall clock, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
    },
    /// The recording was ended on purpose; without this note the file was cut.
    End {
        /// Wall clock, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
    },
    /// Nothing intact came through an open port any more.
    BoardSilent {
        /// Wall clock when it was last heard, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
    },
    /// The board said that it does not stream, and nobody here had stopped it.
    BoardStopped {
        /// Wall clock, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
    },
    /// The host did not keep up (a disk that stands still for longer than its queue lasts), and threw
    /// away what the board sent.
    Overrun {
        /// Wall clock of the first byte thrown away, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
        /// Wall clock when there was room again, milliseconds since 1970-01-01 UTC.
        until_ms: i64,
        /// Bytes thrown away.
        bytes: u64,
    },
    /// After any of the above: the board was found and streams, on where it is or, started again
    /// with the same settings, from index 0.
    StreamBack {
        /// Wall clock, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
    },
    /// A person at the bench marked this place of the stream.
    Mark {
        /// Wall clock, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
        /// What happened, in the person's words; may be empty.
        text: String<MAX_MARK>,
    },
    /// A health record had arrived: both clocks at once, about once a second. What lies between is the way of the
    /// record to the host, so that the host's time is late and never early.
    Clock {
        /// Wall clock, milliseconds since 1970-01-01 UTC.
        unix_ms: i64,
        /// `Health::stamp` of that record, ticks of the board's timer.
        stamp: u64,
        /// A clock of the host that runs evenly and is never set, microseconds since the recording began.
        host_us: u64,
    },
}
