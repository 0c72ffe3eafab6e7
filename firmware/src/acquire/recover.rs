//! Back to good words: rest, RESET, configure, prove, one common SYNC.
//!
//! An axis that fails is left without a clock for 64 data periods, so that its serial
//! interface begins a new byte whatever the bus did to it, then reset and configured like at
//! the start. It has to show an edge of DRDY on its own before the common SYNC makes a gap of 63
//! conversions in all axes: a dead converter costs the others nothing. While X is away, the DRDY
//! of another axis drives the reading. Attempts go on for as long as the stream does, the rest
//! doubling from one to the next up to [`LONGEST_REST_US`].

use ads1281::register::Address;
use ads1281::{IDLE_READINGS, RESET_US, SETTLING_READINGS};
use inm_protocol::Trouble;

use super::axis::State;
use super::{Instrument, Stage};
use crate::Platform;
use crate::converters::trouble;

/// Longest rest between two attempts, microseconds.
const LONGEST_REST_US: u32 = 5_000_000;

/// Data periods in which a configured axis has to show an edge.
const PROOF_READINGS: u32 = SETTLING_READINGS + 16;

impl<P: Platform> Instrument<P> {
    /// Takes an axis out of the stream and tells the host why.
    #[cold]
    #[inline(never)]
    pub(super) fn fail(&mut self, axis: usize, trouble: Trouble, now: u64) {
        self.event(self.position.next_index(), Some(axis as u8), trouble);
        let state = &mut self.axes[axis];
        let rest = self.clock.periods(IDLE_READINGS) << state.attempts.min(16);
        let longest = self
            .clock
            .micros(LONGEST_REST_US)
            .max(self.clock.periods(IDLE_READINGS));
        state.rest(trouble, now + rest.min(longest));
        self.choose_trigger(now);
    }

    /// Takes each axis that is not running one step on, when it is due; `true` if one moved.
    pub(super) fn recover(&mut self, now: u64) -> bool {
        let mut moved = false;
        for axis in 0..self.axes.len() {
            moved |= match self.axes[axis].state {
                State::Running => false,
                State::Resting { until } => now >= until && self.reset_axis(axis, now),
                State::Resetting { until } => now >= until && self.identify_axis(axis, now),
                State::Identified { until } => now >= until && self.configure_axis(axis, now),
                State::Proving { until } => self.prove_axis(axis, now, until),
            };
        }
        moved
    }

    fn reset_axis(&mut self, axis: usize, now: u64) -> bool {
        match self.converters[axis].reset() {
            Ok(()) => {
                let state = &mut self.axes[axis];
                state.counters.resets = state.counters.resets.saturating_add(1);
                state.state = State::Resetting {
                    until: now + self.clock.micros(RESET_US),
                };
            }
            Err(error) => self.fail(axis, trouble(error), now),
        }
        true
    }

    fn identify_axis(&mut self, axis: usize, now: u64) -> bool {
        match self.identify(axis) {
            Ok(()) => {
                self.axes[axis].state = State::Identified {
                    until: now + self.clock.periods(1),
                };
            }
            Err(trouble) => self.fail(axis, trouble, now),
        }
        true
    }

    fn configure_axis(&mut self, axis: usize, now: u64) -> bool {
        match self.write_configuration(axis) {
            Ok(()) => {
                self.axes[axis].state = State::Proving {
                    until: now + self.clock.periods(PROOF_READINGS),
                };
            }
            Err(trouble) => self.fail(axis, trouble, now),
        }
        true
    }

    fn prove_axis(&mut self, axis: usize, now: u64, until: u64) -> bool {
        if self.converters[axis].take_edge() {
            self.rejoin(axis);
            true
        } else if now >= until {
            self.fail(axis, Trouble::Stalled, now);
            true
        } else {
            false
        }
    }

    /// Brings an axis back into the stream.
    #[inline(never)]
    fn rejoin(&mut self, axis: usize) {
        // The silence until the filters are full would mend a slip of the others unseen.
        self.prove_all();
        self.flush_batch();
        self.axes[axis].resume();
        self.choose_trigger(self.platform.now());
        self.recovering[axis] = true;
        self.synchronise(None);
        // SYNC restarts the filters of those that are still being proved, too.
        let proved = self.platform.now() + self.clock.periods(PROOF_READINGS);
        for other in &mut self.axes {
            if let State::Proving { until } = &mut other.state {
                *until = proved;
            }
        }
    }

    /// Reads what a RESET has left in one converter.
    #[inline(never)]
    pub(super) fn identify(&mut self, axis: usize) -> Result<(), Trouble> {
        self.registers[axis] = self.converters[axis].identify().map_err(trouble)?;
        Ok(())
    }

    /// Configures one converter, which was identified before, verifies, learns who it is, and starts
    /// read-continuous mode. A converter that was not up at power-on, or is another one since the
    /// last time, is who it is now.
    #[inline(never)]
    pub(super) fn write_configuration(&mut self, axis: usize) -> Result<(), Trouble> {
        let before = self.registers[axis];
        let registers = self.converters[axis]
            .configure(&self.configs[axis])
            .map_err(trouble)?;
        self.registers[axis] = registers;
        for address in [Address::Id, Address::Config1] {
            let [wrote, found] = [before, registers].map(|registers| registers[address.index()]);
            if wrote != found {
                return Err(Trouble::RegisterLost {
                    address: address as u8,
                    wrote,
                    found,
                });
            }
        }
        self.ids[axis] = Some(registers[Address::Id.index()]);
        self.reserved[axis] = registers[Address::Config1.index()];
        self.converters[axis].read_continuously().map_err(trouble)
    }

    /// RESET to every converter; one that cannot be reached shows when it is configured.
    #[inline(never)]
    pub(super) fn send_reset_to_all(&mut self) {
        for (converter, axis) in self.converters.iter_mut().zip(&mut self.axes) {
            if converter.reset().is_ok() {
                axis.counters.resets = axis.counters.resets.saturating_add(1);
            }
        }
    }

    /// Stops streaming, if it does. What was gathered is sent, and a last health record, so that
    /// the host can prove the stream to its end.
    pub(super) fn end_stream(&mut self, now: u64) {
        if self.is_streaming() {
            self.prove_all();
            self.send_health(now, None);
            self.stage = Stage::Idle;
        }
    }
}
