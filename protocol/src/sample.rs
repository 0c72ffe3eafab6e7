//! Converter words on the wire.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use crate::{AXES, BATCH_LEN};

/// One 32-bit word as it left the converter: 31 bits of value and the redundant sign bit.
///
/// On the wire it takes four bytes, little endian, whatever its value: the load of the link
/// must not depend on the offset of the sensor, as it would with postcard's own variable
/// length integers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[repr(transparent)]
pub struct Code(#[serde(with = "postcard::fixint::le")] pub i32);

/// What is wrong with one word. No bit set means that the word is good.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Flags(pub u8);

impl Flags {
    /// The word is good.
    pub const NONE: Self = Self(0);
    /// Clipped: the redundant sign bit differs at full scale (SBAS378D, page 24).
    pub const OVER_RANGE: Self = Self(1 << 0);
    /// The converter may have updated the word while it was read.
    pub const TORN: Self = Self(1 << 1);
    /// This converter had no new word when the others had one; the code repeats the last.
    pub const MISSED: Self = Self(1 << 2);
    /// The level jumped by a factor of two: a bit slipped, and the axis waits for its reset.
    pub const SLIPPED: Self = Self(1 << 3);
    /// The bus answered all zeros or all ones for too long to be a signal.
    pub const STUCK: Self = Self(1 << 4);

    /// The bits of both.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether every bit of `other` is set here.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether the word is good.
    pub const fn is_none(self) -> bool {
        self.0 == 0
    }
}

/// One flagged word of a [`Batch`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Flag {
    /// Conversion within the batch, from 0.
    pub conversion: u8,
    /// Axis, 0 to 2 for X to Z.
    pub axis: u8,
    /// What is wrong.
    pub flags: Flags,
}

/// Consecutive conversions of all axes, without a gap between them.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Batch {
    /// Sequence number of the batch, counting every batch that the board has filled, sent or
    /// dropped, since the start command; wraps.
    pub seq: u32,
    /// Index of the first conversion, in data periods since the start command. An index that
    /// does not continue the last batch is a gap.
    pub first: u64,
    /// Board timer at the DRDY edge (of X, or of the first axis that runs) of the first
    /// conversion, in ticks of
    /// [`Identity::timer_hz`](crate::Identity::timer_hz).
    pub stamp: u64,
    /// Codes, conversion by conversion, X Y Z.
    pub codes: Vec<[Code; AXES], BATCH_LEN>,
    /// The words that are not good; usually empty.
    pub flags: Vec<Flag, { AXES * BATCH_LEN }>,
    /// The stream that `seq` and `first` count in: number of the start command that began it. 0 where
    /// that is not said, in version 1 and in what no board has sent.
    pub stream: u16,
}

impl Batch {
    /// Index of the conversion that would follow this batch.
    pub fn end(&self) -> u64 {
        self.first.wrapping_add(self.codes.len() as u64)
    }
}
