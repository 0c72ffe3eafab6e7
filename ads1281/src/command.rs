//! Opcodes of the serial interface (SBAS378D, page 30).
//!
//! A command takes effect at the eighth rising edge of SCLK of its last byte.

use super::register::Address;

/// Commands of one byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Command {
    /// Leave stand-by.
    Wakeup = 0x00,
    /// Stop converting; registers are kept.
    Standby = 0x02,
    /// Restart the digital filter: a common point in time for several converters.
    Sync = 0x04,
    /// Registers to their default, filter restarted.
    Reset = 0x06,
    /// Read data continuous: each word is shifted out without being asked for.
    ReadContinuous = 0x10,
    /// Leave read data continuous. Registers can be reached only then.
    StopContinuous = 0x11,
    /// One word by request.
    ReadData = 0x12,
    /// Measure the offset into OFC.
    OffsetCalibration = 0x60,
    /// Measure the gain into FSC. The page read breaks off before this code; it is that of the
    /// vendor's own example code for the family.
    GainCalibration = 0x61,
}

impl Command {
    /// The byte on DIN.
    pub const fn opcode(self) -> u8 {
        self as u8
    }
}

/// RREG: the two bytes ahead of `count` register values on DOUT.
///
/// `count` is 1 to 11; the field holds one less.
pub const fn read_registers(first: Address, count: u8) -> [u8; 2] {
    [0x20 | first as u8, count.saturating_sub(1)]
}

/// WREG: the two bytes ahead of `count` register values on DIN.
///
/// `count` is 1 to 11; the field holds one less.
pub const fn write_registers(first: Address, count: u8) -> [u8; 2] {
    [0x40 | first as u8, count.saturating_sub(1)]
}
