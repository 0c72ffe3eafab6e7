//! What the stamps of a stream, the host's notes and a pulse a second say of the clocks.

use inm_protocol::Pulse;

use super::Frames;
use crate::capture::ClockSource;
use crate::clocks::pulses::Tally;
use crate::clocks::{CRYSTALS, Clocks, INTERNAL, Measured};

/// Variance of a time that is rounded to a tick at both of its ends, evenly, ticks squared.
const ROUNDING: f64 = 2.0 / 12.0;

/// Pulses that wait for a header: half a minute of them, ten times what a start takes.
const EARLY: usize = 60;

impl Frames {
    /// A pulse a second came. Ahead of the header it waits: a recording asks for that while the board streams already, and
    /// a replay has it from the first.
    pub(super) fn pulse(&mut self, pulse: Pulse) {
        match self.timer {
            Some((timer_hz, _)) => self.pulses.push(&pulse, timer_hz),
            None if self.early_pulses.len() < EARLY => self.early_pulses.push(pulse),
            None => {}
        }
    }

    /// What was odd about the pulses of the record, in words.
    pub(super) fn odd_pulses(&self) -> Option<String> {
        let Tally {
            arrived,
            lost,
            counters,
            ..
        } = self.pulses.tally()?;
        let odd = [
            (u64::from(counters.missing), "seconds without one"),
            (u64::from(counters.doubled), "doubled, and left out"),
            (u64::from(counters.odd), "times no whole second apart"),
            (
                u64::from(counters.early),
                "edges within half a second of one, and left out",
            ),
            (*lost, "lost on the link"),
        ];
        let odd = odd.iter().filter(|(count, _)| *count > 0);
        let words: Vec<String> = odd.map(|(count, what)| format!("{count} {what}")).collect();
        (!words.is_empty()).then(|| {
            let words = words.join(", ");
            format!("of the pulse a second {arrived} came: {words}")
        })
    }

    /// The data rate by the stamps of the longest stretch without a gap, by the host's clock and by a pulse a second;
    /// `None` where no stretch is as long as a second, or no header has said what the stamps are.
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
        let (over_host, over_pps) = (self.pairs.ratio(), self.pulses.ratio());
        Some(Clocks::new(rate_hz, good_to, over_host, over_pps))
    }
}
