//! TIM2 as a free-running counter (RM0090, section 18).

use super::Registers;

const CR1: u32 = 0x00;
const EGR: u32 = 0x14;
/// The count.
pub const CNT: u32 = 0x24;
const PSC: u32 = 0x28;

/// The timer.
#[derive(Default)]
pub struct Timer {
    registers: Registers,
    /// Since when it has counted from zero.
    since_ps: Option<u64>,
}

impl Timer {
    pub(super) fn read(&self, offset: u32, now_ps: u64, clock_hz: u64) -> u32 {
        if offset != CNT {
            return self.registers.get(offset);
        }
        let Some(since_ps) = self.since_ps else {
            return 0;
        };
        let input_hz = u128::from(clock_hz) / (u128::from(self.registers.get(PSC)) + 1);
        (u128::from(now_ps - since_ps) * input_hz / 1_000_000_000_000) as u32
    }

    pub(super) fn write(&mut self, offset: u32, value: u32, now_ps: u64) {
        self.registers.set(offset, value);
        let runs = self.registers.get(CR1) & 1 != 0;
        // UG begins anew (18.4.6).
        if runs && (self.since_ps.is_none() || offset == EGR && value & 1 != 0) {
            self.since_ps = Some(now_ps);
        }
    }
}
