//! Pulses of a second: which edges are told to the host, and what is counted of the rest.
//!
//! The board judges nothing: any two pulses may be the right ones. It tells an edge at most every half second, so that
//! an input that picks up anything does not fill the link, and counts what was odd about them.

use inm_protocol::{Pulse, PulseCounters};

use super::Instrument;
use crate::Platform;
use crate::platform::Captured;

/// Part of a second within which a second edge is none of a pulse a second: half leaves the most to either side.
const DEAD: u64 = 2;

/// Part of a second by which pulses may be off: 2 %, twice what the chip's own oscillator is.
const OFF: u64 = 50;

/// Pulses since the start of the board.
#[derive(Debug, Default)]
pub(super) struct Pulses {
    /// Stamp of the last that was told.
    last: Option<u64>,
    number: u32,
    counters: PulseCounters,
}

impl Pulses {
    /// Takes an edge by a timer of `timer_hz` ticks a second; what there is to tell of it.
    fn take(&mut self, edge: Captured, timer_hz: u64) -> Option<Pulse> {
        let Captured { stamp, doubled } = edge;
        let second = timer_hz.max(1);
        if let Some(last) = self.last {
            let ticks = stamp.saturating_sub(last);
            if ticks < second / DEAD {
                count(&mut self.counters.early, 1);
                return None;
            }
            let seconds = ticks.saturating_add(second / 2) / second;
            let whole = seconds.saturating_mul(second);
            if ticks.abs_diff(whole) > whole / OFF {
                count(&mut self.counters.odd, 1);
            } else {
                count(&mut self.counters.missing, seconds.saturating_sub(1));
            }
        }
        self.last = Some(stamp);
        self.number = self.number.wrapping_add(1);
        count(&mut self.counters.doubled, doubled.into());
        Some(Pulse {
            stamp,
            number: self.number,
            doubled,
            counters: self.counters,
        })
    }
}

fn count(counter: &mut u32, more: u64) {
    *counter = counter.saturating_add(u32::try_from(more).unwrap_or(u32::MAX));
}

impl<P: Platform> Instrument<P> {
    /// Looks for a pulse and tells it; `true` if there was one. While the converters stream only where that costs no
    /// conversion: in a step that `converted` none, or one that has time left. The stamp waits in the timer.
    pub(super) fn serve_pulse(&mut self, converted: bool) -> bool {
        if converted && self.is_streaming() && !self.is_prompt() {
            return false;
        }
        let Some(edge) = self.platform.take_pulse() else {
            return false;
        };
        if let Some(pulse) = self.pulses.take(edge, self.board.timer_hz.into()) {
            self.outbox.pulse(&mut self.platform, pulse);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HZ: u64 = 84_000_000;

    /// What is told of edges at these times, milliseconds.
    fn told(pulses: &mut Pulses, at_ms: &[u64]) -> Vec<Option<Pulse>> {
        let edge = |&ms: &u64| Captured {
            stamp: ms * HZ / 1000,
            doubled: false,
        };
        at_ms.iter().map(|ms| pulses.take(edge(ms), HZ)).collect()
    }

    #[test]
    fn a_pulse_a_second_is_told_and_what_is_odd_is_counted() {
        let mut pulses = Pulses::default();
        // One as it should be; an echo; three missing; one between two; the next again in its place.
        let told = told(&mut pulses, &[300, 1300, 1400, 5300, 6000, 6300, 7300]);
        let last = told.last().copied().flatten().expect("it is told");
        let silent: Vec<bool> = told.iter().map(Option::is_none).collect();
        assert_eq!(silent, [false, false, true, false, false, true, false]);
        let expected = PulseCounters {
            early: 2,
            doubled: 0,
            missing: 3,
            odd: 2,
        };
        assert_eq!((last.number, last.counters), (5, expected));
    }

    #[test]
    fn the_internal_oscillator_makes_no_pulse_odd() {
        for off in [-10, 0, 10] {
            let mut pulses = Pulses::default();
            let at: Vec<u64> = (1..20).map(|k| k * (1000 + off) as u64).collect();
            let last = told(&mut pulses, &at).pop().flatten().expect("told");
            assert_eq!(last.counters, PulseCounters::default(), "{off} per mille");
        }
    }

    /// A timer that reads less than before, a stamp at its very end, a timer of no rate: nothing that a platform can say
    /// is a panic.
    #[test]
    fn no_stamp_is_too_odd() {
        for hz in [0, 1, HZ, u64::from(u32::MAX)] {
            let mut pulses = Pulses::default();
            for stamp in [u64::MAX, 0, 1, u64::MAX - 1, 7, u64::MAX / 2] {
                for doubled in [true, false] {
                    pulses.take(Captured { stamp, doubled }, hz);
                }
            }
        }
    }
}
