//! TIM2 as a free-running counter that holds its count at edges of its first channel (RM0090, section 18).

use super::Registers;

const CR1: u32 = 0x00;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCER: u32 = 0x20;
/// The count.
pub const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const CCR1: u32 = 0x34;

/// Flags of SR (18.4.5): channel 1 holds an edge, and took the place of one that nobody had read.
const CC1IF: u32 = 1 << 1;
const CC1OF: u32 = 1 << 9;

/// Channel 1 takes its edges from its own pin (18.4.7), is on, and takes rising ones (18.4.9).
const CC1S: u32 = 0b11;
const FROM_TI1: u32 = 0b01;
const EDGE: u32 = 0b1011;
const RISING: u32 = 0b0001;

/// The timer.
#[derive(Default)]
pub struct Timer {
    registers: Registers,
    /// Since when it has counted from zero.
    since_ps: Option<u64>,
}

impl Timer {
    pub(super) fn read(&mut self, offset: u32, now_ps: u64, clock_hz: u64) -> u32 {
        match offset {
            CNT => self.count(now_ps, clock_hz),
            CCR1 => {
                // Reading it clears its flag (18.4.5).
                self.registers.set(SR, self.registers.get(SR) & !CC1IF);
                self.registers.get(CCR1)
            }
            _ => self.registers.get(offset),
        }
    }

    fn count(&self, now_ps: u64, clock_hz: u64) -> u32 {
        let Some(since_ps) = self.since_ps else {
            return 0;
        };
        let input_hz = u128::from(clock_hz) / (u128::from(self.registers.get(PSC)) + 1);
        (u128::from(now_ps - since_ps) * input_hz / 1_000_000_000_000) as u32
    }

    /// A rising edge at the pin of channel 1. The filter's delay, the same for all, is left out.
    pub(super) fn edge(&mut self, now_ps: u64, clock_hz: u64) {
        let from_pin = self.registers.get(CCMR1) & CC1S == FROM_TI1;
        if !from_pin || self.registers.get(CCER) & EDGE != RISING {
            return;
        }
        let flags = self.registers.get(SR);
        let over = if flags & CC1IF != 0 { CC1OF } else { 0 };
        self.registers.set(SR, flags | over | CC1IF);
        let count = self.count(now_ps, clock_hz);
        self.registers.set(CCR1, count);
    }

    pub(super) fn write(&mut self, offset: u32, value: u32, now_ps: u64) {
        // A zero clears a flag, a one leaves it.
        let value = match offset {
            SR => value & self.registers.get(SR),
            _ => value,
        };
        self.registers.set(offset, value);
        let runs = self.registers.get(CR1) & 1 != 0;
        // UG begins anew (18.4.6).
        if runs && (self.since_ps.is_none() || offset == EGR && value & 1 != 0) {
            self.since_ps = Some(now_ps);
        }
    }
}
