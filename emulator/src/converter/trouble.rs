//! What a fault does to a converter.

use super::{Converter, ReadMode};
use crate::{Fault, Signal, alignment::Alignment, time::UPDATE_LEAD_PS};

impl<S: Signal> Converter<S> {
    /// Lets a fault happen.
    pub(crate) fn suffer(&mut self, at_ps: u64, fault: Fault) {
        match fault {
            Fault::DrdyStops => {
                self.drdy_dead = true;
                self.timeline.hide();
            }
            Fault::BusStuck { high, conversions } => {
                let end = conversions.map_or(u64::MAX, |n| self.ledger.sent.words() + u64::from(n));
                self.stuck = Some((high, end));
            }
            Fault::Slip(slip) => {
                self.serial.slip = Some(slip);
                self.alignment = Alignment::slipped(slip);
            }
            Fault::Overload { input, conversions } => self.conversion.overload(input, conversions),
            Fault::BrownOut => {
                self.realign();
                self.reset(at_ps);
                self.excused = true;
            }
            Fault::WrongId(id) => self.registers.set_id(id),
            Fault::LateRead { bits } => self.late_read = Some(bits.clamp(1, 31)),
            Fault::BusError => self.bus_error = true,
        }
    }

    /// If the controller is to be held up ahead of this read: the time at which it goes on, such
    /// that the next update falls into the word.
    pub(crate) fn held_up_until(&mut self, now_ps: u64, bit_ps: u64) -> Option<u64> {
        let bits = self.late_read?;
        self.catch_up(now_ps);
        let fresh = self
            .timeline
            .fell_ps()
            .is_some_and(|fell| self.timeline.sclk_ps <= fell);
        let fall_ps = self.timeline.fell_ps()? + self.timeline.period_ps();
        let start_ps = (fall_ps - UPDATE_LEAD_PS).checked_sub(u64::from(bits) * bit_ps)?;
        if !fresh || self.mode == ReadMode::Stopped || start_ps < now_ps {
            return None;
        }
        self.late_read = None;
        Some(start_ps)
    }
}
