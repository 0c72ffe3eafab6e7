//! ADC1: single conversions of a channel (RM0090, section 13).

use super::Registers;

const SR: u32 = 0x00;
const CR2: u32 = 0x08;
const SMPR1: u32 = 0x0c;
const SMPR2: u32 = 0x10;
const SQR3: u32 = 0x34;
const DR: u32 = 0x4c;
/// Common control (13.13.16).
const CCR: u32 = 0x304;

/// Bits of SR and CR2 (13.13.1, 13.13.3).
const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const ADON: u32 = 1;
const SWSTART: u32 = 1 << 30;

/// Sample times by their code, clocks (13.13.4), and a conversion of 12 bits behind it (13.5).
const SAMPLE_CLOCKS: [u64; 8] = [3, 15, 28, 56, 84, 112, 144, 480];
const CONVERT_CLOCKS: u64 = 12;

/// The converter.
#[derive(Default)]
pub struct Adc {
    registers: Registers,
    /// End of the conversion under way.
    ends_ps: Option<u64>,
}

impl Adc {
    /// Its clock, hertz, where the bus clock is `pclk2`.
    #[must_use]
    pub fn clock_hz(&self, pclk2: u64) -> u64 {
        pclk2 / u64::from(2 * ((self.registers.get(CCR) >> 16 & 3) + 1))
    }

    /// The channel that is converted.
    pub(super) fn channel(&self) -> u32 {
        self.registers.get(SQR3) & 31
    }

    /// The end of the conversion under way.
    pub(super) fn next_ps(&self) -> Option<u64> {
        self.ends_ps
    }

    /// `value` gives the code of a channel.
    pub(super) fn catch_up(&mut self, now_ps: u64, value: impl FnOnce(u32) -> u32) {
        if self.ends_ps.take_if(|ends| *ends <= now_ps).is_some() {
            let status = self.registers.get(SR);
            self.registers.set(SR, status | EOC);
            self.registers.set(DR, value(self.channel()));
        }
    }

    pub(super) fn read(&mut self, offset: u32) -> u32 {
        if offset == DR {
            let status = self.registers.get(SR);
            self.registers.set(SR, status & !EOC);
        }
        self.registers.get(offset)
    }

    pub(super) fn write(&mut self, offset: u32, value: u32, now_ps: u64, pclk2: u64) {
        let kept = match offset {
            SR => self.registers.get(SR) & value,
            CR2 => value & !SWSTART,
            _ => value,
        };
        self.registers.set(offset, kept);
        if offset == CR2 && value & ADON != 0 && value & SWSTART != 0 {
            let status = self.registers.get(SR);
            self.registers.set(SR, status | STRT);
            self.ends_ps = Some(now_ps + self.conversion_ps(pclk2));
        }
    }

    fn conversion_ps(&self, pclk2: u64) -> u64 {
        let channel = self.channel();
        let code = if channel < 10 {
            self.registers.get(SMPR2) >> (3 * channel)
        } else {
            self.registers.get(SMPR1) >> (3 * (channel - 10))
        };
        let clocks = SAMPLE_CLOCKS[(code & 7) as usize] + CONVERT_CLOCKS;
        clocks * 1_000_000_000_000 / self.clock_hz(pclk2).max(1)
    }
}
