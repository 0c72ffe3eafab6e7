//! The three SPI peripherals as one type.

use embedded_hal::spi::{ErrorType, SpiBus};
use stm32f4xx_hal::spi::{Error, Spi1, Spi2, Spi3};

/// The bus of one axis.
pub enum Bus {
    /// SPI1.
    X(Spi1),
    /// SPI2.
    Y(Spi2),
    /// SPI3.
    Z(Spi3),
}

/// The same call on whichever it is.
macro_rules! each {
    ($self:ident, $bus:ident => $call:expr) => {
        match $self {
            Self::X($bus) => $call,
            Self::Y($bus) => $call,
            Self::Z($bus) => $call,
        }
    };
}

impl ErrorType for Bus {
    type Error = Error;
}

impl SpiBus<u8> for Bus {
    fn read(&mut self, words: &mut [u8]) -> Result<(), Error> {
        each!(self, bus => bus.read(words))
    }

    fn write(&mut self, words: &[u8]) -> Result<(), Error> {
        each!(self, bus => bus.write(words))
    }

    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), Error> {
        each!(self, bus => bus.transfer(read, write))
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Error> {
        each!(self, bus => bus.transfer_in_place(words))
    }

    fn flush(&mut self) -> Result<(), Error> {
        each!(self, bus => SpiBus::flush(bus))
    }
}
