//! Whether the link can carry what the converters make.

use crate::{AXES, BATCH_LEN, Filter, Settings};

/// Bits on the line for each byte: start, eight data, stop.
const BITS_PER_BYTE: u32 = 10;

/// Bytes of one full batch on the wire with no word flagged, at most: payload without flags,
/// COBS (one byte, one more each 254) and the closing zero.
const BATCH_FRAME: u32 = {
    let payload = 36 + BATCH_LEN * AXES * 4;
    (payload + 1 + payload / 254 + 1) as u32
};

/// Bytes a second left for health, events and replies.
const RESERVE: u32 = 2000;

/// Need and capacity of the link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Load {
    /// Bytes a second that the settings produce.
    pub needed: u32,
    /// Bytes a second that the link carries.
    pub available: u32,
}

impl Load {
    /// Whether the link can carry it.
    pub const fn fits(self) -> bool {
        self.needed <= self.available
    }
}

/// Bytes a second of a serial link at `baud` bit/s.
pub const fn link_bytes_per_s(baud: u32) -> u32 {
    baud / BITS_PER_BYTE
}

/// Load of a link at `baud` bit/s under these settings, three axes, every word good.
///
/// At 4000/s and 921600 baud: 125 batches of 423 bytes and the reserve, 59 % of 92160 byte/s.
///
/// ```
/// use inm_protocol::{Filter, Rate, Settings, samples_load};
///
/// let fastest = Settings { rate: Rate::Sps4000, filter: Filter::default() };
/// assert!(samples_load(fastest, 921_600).fits());
/// let sinc = Settings { rate: Rate::Sps250, filter: Filter::Sinc };
/// assert!(!samples_load(sinc, 921_600).fits());
/// ```
pub const fn samples_load(settings: Settings, baud: u32) -> Load {
    let conversions = match settings.filter {
        // fMOD = 1.024 MHz, two one-bit streams that take a byte an axis.
        Filter::Modulator => {
            return Load {
                needed: 1_024_000 * AXES as u32,
                available: link_bytes_per_s(baud),
            };
        }
        Filter::Sinc => 32 * settings.rate.hz(),
        Filter::Fir { .. } => settings.rate.hz(),
    };
    let batches = conversions.div_ceil(BATCH_LEN as u32);
    Load {
        needed: batches * BATCH_FRAME + RESERVE,
        available: link_bytes_per_s(baud),
    }
}
