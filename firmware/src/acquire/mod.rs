//! The instrument: three converters to batches, health and events; commands to replies.

use inm_protocol::AXES;

use crate::Platform;
use crate::ads1281::Ads1281;

/// Driver of one converter on platform `P`.
pub type Converter<P> =
    Ads1281<<P as Platform>::Spi, <P as Platform>::Drdy, <P as Platform>::Delay>;

/// The whole board above its [`Platform`].
pub struct Instrument<P: Platform> {
    platform: P,
    converters: [Converter<P>; AXES],
    sync: P::Sync,
}

impl<P: Platform> Instrument<P> {
    /// Takes the machine, the converters X, Y, Z and the SYNC pin. Nothing is sent yet.
    pub fn new(platform: P, converters: [Converter<P>; AXES], sync: P::Sync) -> Self {
        Self {
            platform,
            converters,
            sync,
        }
    }

    /// Does what there is to do and returns: `true` when something was done, `false` when the
    /// caller may sleep until the next interrupt.
    ///
    /// Takes about 100 us when a conversion is read, about 1 ms when the converters are
    /// configured, and never waits for anything.
    pub fn step(&mut self) -> bool {
        self.platform.feed_watchdog();
        false
    }

    /// The machine.
    pub fn platform(&self) -> &P {
        &self.platform
    }

    /// The machine, to drive it from outside.
    pub fn platform_mut(&mut self) -> &mut P {
        &mut self.platform
    }

    /// Gives everything back.
    pub fn release(self) -> (P, [Converter<P>; AXES], P::Sync) {
        (self.platform, self.converters, self.sync)
    }
}
