//! DRDY, SYNC and delays, as embedded-hal sees them.

use core::convert::Infallible;

use embedded_hal::{
    delay::DelayNs,
    digital::{ErrorType, InputPin, OutputPin},
};

use crate::{Bench, Signal};

/// The DRDY pin of one converter, active low.
#[derive(Debug)]
pub struct Drdy<'a, S> {
    bench: &'a Bench<S>,
    axis: usize,
}

impl<'a, S: Signal> Drdy<'a, S> {
    pub(crate) fn new(bench: &'a Bench<S>, axis: usize) -> Self {
        Self { bench, axis }
    }

    /// Whether DRDY has fallen since the last call, like the pending bit of an edge interrupt.
    /// Several edges are one.
    pub fn take_edge(&mut self) -> bool {
        core::mem::take(&mut self.bench.converter(self.axis).timeline().edge)
    }
}

impl<S> ErrorType for Drdy<'_, S> {
    type Error = Infallible;
}

impl<S: Signal> InputPin for Drdy<'_, S> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        self.is_low().map(|low| !low)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(self.bench.converter(self.axis).timeline().is_low())
    }
}

/// The SYNC line of all converters.
#[derive(Debug)]
pub struct SyncPin<'a, S> {
    bench: &'a Bench<S>,
}

impl<'a, S: Signal> SyncPin<'a, S> {
    pub(crate) fn new(bench: &'a Bench<S>) -> Self {
        Self { bench }
    }
}

impl<S> ErrorType for SyncPin<'_, S> {
    type Error = Infallible;
}

impl<S: Signal> OutputPin for SyncPin<'_, S> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.bench.set_sync(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.bench.set_sync(true);
        Ok(())
    }
}

/// Delays in virtual time.
#[derive(Debug)]
pub struct Delay<'a, S> {
    bench: &'a Bench<S>,
}

impl<'a, S: Signal> Delay<'a, S> {
    pub(crate) fn new(bench: &'a Bench<S>) -> Self {
        Self { bench }
    }
}

impl<S: Signal> DelayNs for Delay<'_, S> {
    fn delay_ns(&mut self, ns: u32) {
        self.bench.advance_ps(u64::from(ns) * 1000);
    }
}
