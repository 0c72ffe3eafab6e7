//! Short waits.

use embedded_hal::delay::DelayNs;

use crate::image::clock;

/// Waits by watching the clock, whose ticks are `timer_hz` a second.
#[derive(Clone, Copy)]
pub struct Delay {
    /// Ticks a second.
    pub timer_hz: u32,
}

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        // One more for the tick that is under way.
        let ticks = (u64::from(ns) * u64::from(self.timer_hz)).div_ceil(1_000_000_000) + 1;
        let begin = clock::now();
        while clock::now() - begin < ticks {}
    }
}
