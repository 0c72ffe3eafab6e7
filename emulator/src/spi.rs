//! A converter's SPI bus, as embedded-hal sees it.

use core::{cell::Cell, fmt};

use embedded_hal::spi::{Error, ErrorKind, ErrorType, SpiBus};

use crate::{Bench, Signal};

/// Level on DIN where embedded-hal leaves it to the implementation.
///
/// Not zero on purpose: a driver that relies on it works with one HAL and not with the next, and
/// this part decodes DIN even while it is read. Use `transfer_in_place` on zeros.
const FILLER: u8 = 0xFF;

/// What goes wrong on a bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum BusError {
    /// The controller lost a byte ([`Fault::BusError`](crate::Fault::BusError)).
    Overrun,
}

impl fmt::Display for BusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SPI overrun")
    }
}

impl core::error::Error for BusError {}

impl Error for BusError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Overrun
    }
}

/// The SPI bus of one converter, mode 0.
#[derive(Debug)]
pub struct Spi<'a, S> {
    bench: &'a Bench<S>,
    axis: usize,
}

impl<'a, S: Signal> Spi<'a, S> {
    pub(crate) fn new(bench: &'a Bench<S>, axis: usize) -> Self {
        Self { bench, axis }
    }

    fn ready(&self) -> Result<(), BusError> {
        let overrun = core::mem::take(&mut self.bench.converter(self.axis).bus_error);
        if overrun {
            Err(BusError::Overrun)
        } else {
            Ok(())
        }
    }
}

impl<S> ErrorType for Spi<'_, S> {
    type Error = BusError;
}

impl<S: Signal> SpiBus<u8> for Spi<'_, S> {
    fn read(&mut self, words: &mut [u8]) -> Result<(), BusError> {
        self.ready()?;
        let bytes = words.len();
        self.bench
            .clock(self.axis, bytes, |_| FILLER, |i, byte| words[i] = byte);
        Ok(())
    }

    fn write(&mut self, words: &[u8]) -> Result<(), BusError> {
        self.ready()?;
        self.bench
            .clock(self.axis, words.len(), |i| words[i], |_, _| {});
        Ok(())
    }

    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), BusError> {
        self.ready()?;
        let bytes = read.len().max(write.len());
        let get = |i: usize| write.get(i).copied().unwrap_or(FILLER);
        self.bench.clock(self.axis, bytes, get, |i, byte| {
            if let Some(place) = read.get_mut(i) {
                *place = byte;
            }
        });
        Ok(())
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), BusError> {
        self.ready()?;
        let words = Cell::from_mut(words).as_slice_of_cells();
        let put = |i: usize, byte| words[i].set(byte);
        self.bench
            .clock(self.axis, words.len(), |i| words[i].get(), put);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), BusError> {
        Ok(())
    }
}
