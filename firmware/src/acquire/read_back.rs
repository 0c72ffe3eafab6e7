//! Registers read back while streaming, one at a time between two conversions.
//!
//! A brown-out leaves a converter at its defaults and converting; a slipped bit shifts what a
//! register shows as it shifts the words. Where DRDY gives reason, CONFIG0 is looked at at once.

use inm_protocol::{AXES, REGISTERS, Trouble};

use super::Instrument;
use crate::Platform;
use crate::ads1281::Error;
use crate::ads1281::register::{Address, id_is_plausible};

/// Conversions between two registers read back: all 33 take 528, a quarter second at 2000/s.
const EVERY: u32 = 16;

/// Which register comes next, and when.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rounds {
    /// Conversions to wait.
    wait: u32,
    /// The next in turn, 0 to 32: axis by axis within an address.
    turn: usize,
    /// An axis whose CONFIG0 is to be looked at now.
    suspect: Option<usize>,
}

impl Rounds {
    /// Gives reason to look at the CONFIG0 of `axis` at once.
    pub(super) fn suspect(&mut self, axis: usize) {
        self.suspect = Some(axis);
    }

    /// The axis and register to read back now, if it is time.
    fn next(&mut self) -> Option<(usize, Address)> {
        if let Some(axis) = self.suspect.take() {
            return Some((axis, Address::Config0));
        }
        if self.wait > 0 {
            self.wait -= 1;
            return None;
        }
        self.wait = EVERY - 1;
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
        let Some((axis, address)) = self.rounds.next() else {
            return;
        };
        if !self.axes[axis].is_steady() || !self.clock.in_time_to_check(stamp, self.platform.now())
        {
            return;
        }
        let trouble = match self.check(axis, address) {
            Ok(None) => return,
            Ok(Some(trouble)) => trouble,
            Err(error) => error.trouble(),
        };
        let now = self.platform.now();
        self.fail(axis, trouble, now);
    }

    /// What is wrong with one register.
    fn check(&mut self, axis: usize, address: Address) -> Result<Option<Trouble>, Error> {
        let found = self.converters[axis].check_register(address)?;
        self.registers[axis][address.index()] = found;
        let trouble = match (address, self.configs[axis].expected(address)) {
            (Address::Id, _) if !id_is_plausible(found) || self.ids[axis] != Some(found) => {
                Trouble::WrongId { found }
            }
            (_, Some(wrote)) if wrote != found => Trouble::RegisterLost {
                address: address as u8,
                wrote,
                found,
            },
            _ => return Ok(None),
        };
        // Lost, or shifted on its way here? CONFIG0 looks different shifted and at reset. There
        // is time for it: this axis is not read until it has been reset.
        let wrote = self.configs[axis].config0.bits();
        let shown = self.converters[axis].check_register(Address::Config0)?;
        let slipped = shifted(wrote, shown).map(|doubled| Trouble::Slipped { doubled });
        Ok(Some(slipped.unwrap_or(trouble)))
    }
}

/// Whether `shown` is `wrote` one bit early (`true`: doubled) or late (`false`). The bit that
/// comes in at the end may be anything.
fn shifted(wrote: u8, shown: u8) -> Option<bool> {
    if shown & !1 == wrote << 1 {
        Some(true)
    } else if shown & 0x7F == wrote >> 1 {
        Some(false)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every CONFIG0 that is written, all rates with the FIR stages on, against itself and reset.
    #[test]
    fn a_shift_is_told_from_a_loss() {
        for config0 in (0x40_u8..0x68).filter(|bits| bits & 0b10 != 0) {
            for bit in [0, 1] {
                assert_eq!(shifted(config0, config0 << 1 | bit), Some(true));
                assert_eq!(shifted(config0, config0 >> 1 | bit << 7), Some(false));
            }
            for other in [config0, 0x52, 0x00, 0xFF] {
                assert_eq!(shifted(config0, other), None, "{config0:02X}h {other:02X}h");
            }
        }
    }

    #[test]
    fn every_register_has_its_turn() {
        let mut rounds = Rounds::default();
        let mut seen = [[0; REGISTERS]; AXES];
        for _ in 0..EVERY as usize * AXES * REGISTERS {
            if let Some((axis, address)) = rounds.next() {
                seen[axis][address.index()] += 1;
            }
        }
        assert_eq!(seen, [[1; REGISTERS]; AXES]);
        rounds.suspect(2);
        assert_eq!(rounds.next(), Some((2, Address::Config0)));
    }
}
