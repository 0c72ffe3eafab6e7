//! SPI as a master of eight bits: two buffers and a shift register (RM0090, section 28).

use super::Registers;

const CR1: u32 = 0x00;
const SR: u32 = 0x08;
/// The data register.
pub const DR: u32 = 0x0c;

/// Bits of SR (28.5.3).
const RXNE: u32 = 1;
const TXE: u32 = 1 << 1;
const OVR: u32 = 1 << 6;
const BSY: u32 = 1 << 7;

/// Bits of CR1 (28.5.1): all that must be so for the converter, mode 0, master, enabled, highest bit
/// first, eight bits, slave select by software and high.
const NEEDED: u32 = 1 << 2 | 1 << 6 | 0b11 << 8;
const NEEDED_OF: u32 = NEEDED | 0b11 | 1 << 7 | 1 << 10 | 1 << 11 | 1 << 13 | 1 << 15;

/// A bus.
#[derive(Default)]
pub struct Spi {
    registers: Registers,
    waiting: Option<u8>,
    /// End of the byte in the shift register, and what it brings.
    shifting: Option<(u64, u8)>,
    received: Option<u8>,
    overrun: bool,
    /// The shift register's clock does not come: a fault that a test asks for.
    pub stalled: bool,
}

impl Spi {
    /// SCLK, hertz, where the bus clock is `pclk`.
    #[must_use]
    pub fn sclk_hz(&self, pclk: u64) -> u64 {
        pclk / (2 << (self.registers.get(CR1) >> 3 & 7))
    }

    /// Whether it is set up as the converter needs it.
    #[must_use]
    pub fn suits(&self) -> bool {
        self.registers.get(CR1) & NEEDED_OF == NEEDED
    }

    /// The byte that may begin now.
    pub(super) fn take_waiting(&mut self) -> Option<u8> {
        if self.shifting.is_some() || self.stalled {
            return None;
        }
        self.waiting.take()
    }

    /// A byte is on its way until `end_ps` and brings `dout`.
    pub(super) fn shift(&mut self, end_ps: u64, dout: u8) {
        self.shifting = Some((end_ps, dout));
    }

    /// When the byte under way ends.
    pub(super) fn next_ps(&self) -> Option<u64> {
        self.shifting.map(|(end_ps, _)| end_ps)
    }

    pub(super) fn catch_up(&mut self, now_ps: u64) {
        if let Some((_, dout)) = self.shifting.take_if(|(end_ps, _)| *end_ps <= now_ps) {
            // What nobody fetched stays, and the new byte is lost (28.3.10).
            self.overrun |= self.received.is_some();
            self.received.get_or_insert(dout);
        }
    }

    pub(super) fn read(&mut self, offset: u32) -> u32 {
        let flag = |set, bit| if set { bit } else { 0 };
        match offset {
            SR => {
                flag(self.received.is_some(), RXNE)
                    | flag(self.waiting.is_none(), TXE)
                    | flag(self.overrun, OVR)
                    | flag(self.shifting.is_some() || self.waiting.is_some(), BSY)
            }
            DR => {
                self.overrun = false;
                u32::from(self.received.take().unwrap_or(0))
            }
            _ => self.registers.get(offset),
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) {
        if offset == DR {
            self.waiting = Some(value as u8);
        } else {
            self.registers.set(offset, value);
        }
    }
}
