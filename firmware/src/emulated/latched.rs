//! The emulator's converters as the driver wants them: neither knows the other.

use core::convert::Infallible;

use ads1281::{Ads1281, DataReady};
use embedded_hal::digital::{ErrorType, InputPin};
use inm_emulator::{Bench, Delay, Drdy, Signal, Spi};

/// An emulated DRDY as the driver wants it: the emulator knows no driver, and the driver no emulator.
#[derive(Debug)]
pub struct Latched<'b, S>(pub Drdy<'b, S>);

impl<S> ErrorType for Latched<'_, S> {
    type Error = Infallible;
}

impl<S: Signal> InputPin for Latched<'_, S> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        self.0.is_high()
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.0.is_low()
    }
}

impl<S: Signal> DataReady for Latched<'_, S> {
    fn take_edge(&mut self) -> bool {
        self.0.take_edge()
    }
}

/// The converter of an axis, 0 to 2, on the emulator's bench.
pub fn converter<S: Signal>(
    bench: &Bench<S>,
    axis: usize,
) -> Ads1281<Spi<'_, S>, Latched<'_, S>, Delay<'_, S>> {
    Ads1281::new(bench.spi(axis), Latched(bench.drdy(axis)), bench.delay())
}
