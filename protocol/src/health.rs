//! The record that the board sends once a second.

use serde::{Deserialize, Serialize};

use crate::{AXES, REGISTERS};

/// State of the board; sent at 1 Hz, streaming or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Health {
    /// Board timer, ticks.
    pub stamp: u64,
    /// Index of the next conversion; 0 when not streaming.
    pub index: u64,
    /// Whether samples are being sent.
    pub streaming: bool,
    /// Temperature of the microcontroller, 0.01 degC; `None` where it has no sensor.
    pub mcu_centi_celsius: Option<i16>,
    /// Supply of the accelerometers, millivolts; `None` where it is not measured.
    pub supply_mv: Option<u16>,
    /// Registers 00h to 0Ah of X, Y, Z as last read back, one at a time between conversions.
    pub registers: [[u8; REGISTERS]; AXES],
    /// Trouble by axis since the start of the board.
    pub axes: [AxisCounters; AXES],
    /// Trouble of the link since the start of the board.
    pub link: LinkCounters,
    /// Conversions skipped since the start command because no DRDY edge was seen in time.
    pub lost_conversions: u64,
    /// Most stack ever used, bytes; 0 where it is not measured.
    pub stack_used: u32,
    /// Stack there is, bytes.
    pub stack_size: u32,
    /// The board's own bins; `None` when not streaming, or while they wait for their beginning.
    pub bins: Option<BinsMark>,
    /// The stream that `index` counts in, as [`Batch::stream`](crate::Batch::stream); 0 when not
    /// streaming.
    pub stream: u16,
}

/// What the board has accumulated of its stream, in short. A host that has received the same
/// words, flags and gaps has the same digests; `WIRE.md` says how they are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct BinsMark {
    /// Conversion with which the bins began.
    pub epoch: u64,
    /// The conversion after the last one in them, which is the end of the last batch handed to
    /// the link.
    pub index: u64,
    /// Digest of the bins of X, Y, Z.
    pub digests: [u64; AXES],
}

/// Words flagged, and what was done about them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct AxisCounters {
    /// Clipped words.
    pub over_range: u32,
    /// Words that may have changed while being read.
    pub torn: u32,
    /// Conversions at which this axis had no new word.
    pub missed: u32,
    /// Times a bit slipped: the level jumped by a factor of two and stayed, or commands were not
    /// understood.
    pub slipped: u32,
    /// Times the bus answered all ones or all zeros, or reported a fault.
    pub stuck: u32,
    /// Times DRDY stopped.
    pub stalled: u32,
    /// Times a register was found to differ from what was written, or the identity from what it
    /// was. Slipped, stuck, stalled and this one make as many as there are events
    /// ([`Trouble::is_reset_for`](crate::Trouble::is_reset_for)).
    pub registers_lost: u32,
    /// Resets of the converter since the start of the board.
    pub resets: u32,
}

/// The link, seen from the board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct LinkCounters {
    /// Frames handed to the transmitter.
    pub frames_sent: u32,
    /// Frames given up because the transmit queue was full.
    pub frames_dropped: u32,
    /// Frames from the host that did not decode.
    pub frames_bad: u32,
    /// Bytes from the host that were lost or thrown away.
    pub bytes_lost: u32,
}
