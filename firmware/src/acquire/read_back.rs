//! Registers read back while streaming, one at a time between two conversions.
//!
//! A brown-out leaves a converter at its defaults and converting. CONFIG0 is read much more often,
//! since it proves the words too (`prove`); where DRDY gives reason, at once.

use ads1281::register::{Address, id_is_plausible};
use inm_protocol::{AXES, REGISTERS, Trouble};

use super::Instrument;
use crate::Platform;
use crate::converters::trouble;

/// Conversions between two registers read back: 10 of each axis take 720, a third of a second at
/// 2000/s.
const EVERY: u32 = 24;

/// Which register comes next, and when.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rounds {
    /// Conversions to wait.
    wait: u32,
    /// The next in turn, 0 to 32: axis by axis within an address.
    turn: usize,
}

impl Rounds {
    /// The axis and register to read back now, if it is time.
    fn next(&mut self) -> Option<(usize, Address)> {
        if self.wait > 0 {
            self.wait -= 1;
            return None;
        }
        self.wait = EVERY - 1;
        if self.turn / AXES == Address::Config0.index() {
            self.turn += AXES;
        }
        let turn = self.turn;
        self.turn = (turn + 1) % (AXES * REGISTERS);
        let address = Address::ALL.get(turn / AXES)?;
        Some((turn % AXES, *address))
    }
}

impl<P: Platform> Instrument<P> {
    /// Reads one register back and compares it with what was written, if it is time and there
    /// is time.
    pub(super) fn read_back(&mut self, stamp: u64) {
        let in_time = self.clock.in_time_to_check(stamp, self.platform.now());
        if let Some(axis) = self.due(in_time) {
            self.prove(axis);
            return;
        }
        let Some((axis, address)) = self.rounds.next() else {
            return;
        };
        if !self.axes[axis].is_steady() || !in_time {
            return;
        }
        if let Err(trouble) = self.check(axis, address) {
            self.fail(axis, trouble, self.platform.now());
        }
    }

    /// What is wrong with one register.
    fn check(&mut self, axis: usize, address: Address) -> Result<(), Trouble> {
        let found = self.converters[axis]
            .check_register(address)
            .map_err(trouble)?;
        self.registers[axis][address.index()] = found;
        let lost = |wrote| Trouble::RegisterLost {
            address: address as u8,
            wrote,
            found,
        };
        let trouble = match (address, self.configs[axis].expected(address)) {
            (Address::Id, _) if !id_is_plausible(found) || self.ids[axis] != Some(found) => {
                Trouble::WrongId { found }
            }
            (_, Some(wrote)) if wrote != found => lost(wrote),
            (Address::Config1, None) if self.reserved[axis] != found => lost(self.reserved[axis]),
            _ => return Ok(()),
        };
        // Lost, or not understood? CONFIG0 tells. There is time for it: this axis is not read
        // until it has been reset.
        match self.look(axis) {
            Err(Trouble::Misaligned) => Err(Trouble::Misaligned),
            _ => Err(trouble),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_register_but_config0_has_its_turn() {
        let mut rounds = Rounds::default();
        let mut seen = [[0; REGISTERS]; AXES];
        for _ in 0..EVERY as usize * AXES * (REGISTERS - 1) {
            if let Some((axis, address)) = rounds.next() {
                seen[axis][address.index()] += 1;
            }
        }
        let once = Address::ALL.map(|address| u32::from(address != Address::Config0));
        assert_eq!(seen, [once; AXES]);
    }
}
