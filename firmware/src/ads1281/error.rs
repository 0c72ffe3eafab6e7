//! What can go wrong between the driver and its converter.

use embedded_hal::spi;
use inm_protocol::Trouble;

use super::register::Address;

/// Why an operation failed. Small, comparable, and without the bus's own type: the value
/// crosses the link as a [`Trouble`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The SPI peripheral reported a fault.
    Bus(#[cfg_attr(target_os = "none", defmt(Debug2Format))] spi::ErrorKind),
    /// The DRDY pin could not be read.
    Pin,
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

impl Error {
    /// A fault of the bus, whatever its own type.
    #[allow(clippy::needless_pass_by_value)] // for `map_err(Error::bus)`
    pub(super) fn bus<E: spi::Error>(error: E) -> Self {
        Self::Bus(error.kind())
    }

    /// As it is told to the host.
    pub const fn trouble(self) -> Trouble {
        match self {
            Self::Bus(_) | Self::Pin | Self::Mode => Trouble::Bus,
            Self::WrongId { found } => Trouble::WrongId { found },
            Self::Verify {
                address,
                wrote,
                found,
            } => Trouble::RegisterLost {
                address: address as u8,
                wrote,
                found,
            },
        }
    }
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Bus(kind) => write!(f, "SPI bus: {kind}"),
            Self::Pin => f.write_str("DRDY cannot be read"),
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

impl core::error::Error for Error {}
