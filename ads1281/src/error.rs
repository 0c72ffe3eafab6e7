//! What can go wrong between the driver and its converter.

use core::fmt::Debug;

use embedded_hal::digital;

use super::register::Address;

/// Why an operation failed. `B` is the error of the bus, kept as it came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error<B> {
    /// The SPI peripheral reported a fault.
    Bus(B),
    /// DRDY could not be read, or RESET not be driven.
    Pin(#[cfg_attr(feature = "defmt", defmt(Debug2Format))] digital::ErrorKind),
    /// The ID register cannot be that of an ADS1281.
    WrongId {
        /// What was read.
        found: u8,
    },
    /// A register does not read what was written.
    Verify {
        /// Its address.
        address: Address,
        /// What was written.
        wrote: u8,
        /// What was read.
        found: u8,
    },
    /// A word was asked for in a mode that has none.
    Mode,
}

impl<B: Debug> core::fmt::Display for Error<B> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "SPI bus: {error:?}"),
            Self::Pin(kind) => write!(f, "DRDY or RESET: {kind}"),
            Self::WrongId { found } => write!(f, "ID register {found:02X}h, not an ADS1281"),
            Self::Verify {
                address,
                wrote,
                found,
            } => write!(
                f,
                "register {:02X}h reads {found:02X}h, not {wrote:02X}h as written",
                *address as u8
            ),
            Self::Mode => f.write_str("a word was read outside the data modes"),
        }
    }
}

impl<B: Debug> core::error::Error for Error<B> {}
