//! What the stamps of a stream and the host's notes say of the clocks.

use super::Frames;
use crate::capture::ClockSource;
use crate::clocks::{CRYSTALS, Clocks, INTERNAL, Measured};

/// Variance of a time that is rounded to a tick at both of its ends, evenly, ticks squared.
const ROUNDING: f64 = 2.0 / 12.0;

impl Frames {
    /// The data rate by the stamps of the longest stretch without a gap, and by the host's clock; `None` where
    /// no stretch is as long as a second, or no header has said what the stamps are.
    pub fn clocks(&self) -> Option<Clocks> {
        let (timer_hz, clock) = self.timer?;
        let stretch = self.assembler.longest_stretch();
        let (spread, freedom) = stretch.spread()?;
        if stretch.ticks < u64::from(timer_hz) {
            return None;
        }
        let ticks = stretch.ticks as f64;
        let value = stretch.conversions as f64 / ticks * f64::from(timer_hz);
        let rate_hz = Measured {
            value,
            sd: value * (spread * spread).max(ROUNDING).sqrt() / ticks,
            freedom,
        };
        let good_to = match clock {
            ClockSource::Crystal | ClockSource::Emulated => CRYSTALS,
            // Who was not asked may have had no crystal.
            ClockSource::Internal | ClockSource::Unknown => INTERNAL,
        };
        Some(Clocks::new(rate_hz, good_to, self.pairs.ratio()))
    }
}
