//! Proof that no bit of an axis has slipped, before anything happens that would hide it.
//!
//! CONFIG0 is read back. Behind a slip the converter does not even understand the question, and
//! after a brown-out it shows its default. What reads as written proves all words that the axis
//! has given since the proof before, because nothing between mends a slip: that takes 64 data
//! periods without a clock, RESET behind them, or the supply. Ahead of each of those the axis is
//! proved, or the host is told, and leaves out [`UNPROVEN_PERIODS`].

use ads1281::IDLE_READINGS;
use ads1281::config::Config;
use ads1281::register::Address;
use inm_protocol::{AXES, Trouble, UNPROVEN_PERIODS};

use super::Instrument;
use super::axis::STALLED;
use crate::Platform;
use crate::converters::trouble;

/// Data periods after which an axis is due, if its words look usual and there is time. At 4000/s
/// three checks in 72 periods take 1 % of the time.
const EVERY: u64 = 72;

/// Data periods after which it is done whatever the words and the time are like. In between there
/// is room for the 16 words that a jump of the level has to last to be called a slip.
const AT_LATEST: u64 = 96;

/// A gap of fewer data periods only brings the proof on; a longer one asks for it at once.
const SHORT_GAP: u64 = 8;

/// Three axes may be due at once, one is proved a conversion, and each may be a short gap apart;
/// and an axis without an edge is proved no more, but stalled soon.
const _: () = assert!(AT_LATEST + AXES as u64 * SHORT_GAP + STALLED as u64 <= UNPROVEN_PERIODS);

impl<P: Platform> Instrument<P> {
    /// The axis to prove now. `in_time`: the next conversion is far enough.
    pub(super) fn due(&self, in_time: bool) -> Option<usize> {
        let next = self.position.next_index();
        let urgency = |axis: usize| {
            let state = &self.axes[axis];
            let age = next.saturating_sub(state.proven);
            let at_once = state.suspected && in_time || age >= AT_LATEST && !state.is_missing();
            let due = age >= EVERY && state.is_steady() && !state.is_missing() && in_time;
            (state.is_running() && (at_once || due)).then_some((at_once, age, axis))
        };
        (0..AXES).filter_map(urgency).max().map(|(_, _, axis)| axis)
    }

    /// Proves the words of one axis, or takes it out of the stream.
    pub(super) fn prove(&mut self, axis: usize) {
        let next = self.position.next_index();
        let looked = self.look(axis);
        let state = &mut self.axes[axis];
        state.suspected = false;
        match looked {
            // In the silence of a brown-out a register may read as written by chance.
            Ok(()) if state.is_missing() => {}
            Ok(()) => state.proven = next,
            Err(trouble) => self.fail(axis, trouble, self.platform.now()),
        }
    }

    /// Proves all words that were read of all running axes; an axis that cannot be proved is
    /// taken out of the stream.
    pub(super) fn prove_all(&mut self) {
        let next = self.position.next_index();
        for axis in 0..AXES {
            let state = &self.axes[axis];
            if !state.is_running() || state.proven >= next {
                continue;
            }
            if state.is_missing() {
                self.fail(axis, Trouble::Stalled, self.platform.now());
            } else {
                self.prove(axis);
            }
        }
    }

    /// The board was late, or DRDY was: `lost` conversions are missing ahead of the one that is
    /// about to be read.
    #[cold]
    pub(super) fn unforeseen_gap(&mut self, lost: u64) {
        if lost < SHORT_GAP {
            for axis in &mut self.axes {
                axis.suspected = true;
            }
        } else if lost + 4 < u64::from(IDLE_READINGS) {
            self.prove_all();
        } else {
            // The interfaces may have timed out, and what was wrong before is so no more.
            for axis in 0..AXES {
                if self.axes[axis].is_running() {
                    self.fail(axis, Trouble::Stalled, self.platform.now());
                }
            }
        }
    }

    /// What CONFIG0 says of an axis.
    #[inline(never)]
    pub(super) fn look(&mut self, axis: usize) -> Result<(), Trouble> {
        let address = Address::Config0;
        let wrote = self.configs[axis].config0.bits();
        let found = self.converters[axis]
            .check_register(address)
            .map_err(trouble)?;
        self.registers[axis][address.index()] = found;
        if found == wrote {
            Ok(())
        } else if found == Config::default().config0.bits() {
            Err(Trouble::RegisterLost {
                address: address as u8,
                wrote,
                found,
            })
        } else {
            Err(Trouble::Misaligned)
        }
    }
}
