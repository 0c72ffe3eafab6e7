//! A byte clocked in and out of a converter.

use super::{Converter, ReadMode};
use crate::{
    Rule, Signal,
    alignment::Alignment,
    command::Byte,
    time::{INTERFACE_TIMEOUT_CONVERSIONS, POWER_ON_PS, SHORTEST_SCLK_PS},
};

impl<S: Signal> Converter<S> {
    /// Clocks a byte in and out: SCLK runs from `start_ps` with a period of `bit_ps`.
    pub(crate) fn clock(&mut self, start_ps: u64, bit_ps: u64, din: u8) -> u8 {
        self.catch_up(start_ps);
        if start_ps < POWER_ON_PS {
            self.breach(start_ps, Rule::PowerOn);
        }
        if bit_ps < SHORTEST_SCLK_PS {
            self.breach(start_ps, Rule::SclkTooFast);
        }
        let timeout = INTERFACE_TIMEOUT_CONVERSIONS * self.timeline.period_ps();
        if start_ps - self.timeline.sclk_ps >= timeout {
            self.realign();
        }
        if self.requested && din < 2 {
            self.breach(start_ps, Rule::RdataBeforeReady);
        }

        let end_ps = start_ps + 8 * bit_ps;
        let last_ps = end_ps - bit_ps / 2;
        let dout = if let Some(address) = self.decoder.register() {
            let value = self.registers.get(address).unwrap_or(0);
            self.serial.register(value)
        } else if self.timeline.next_ps().is_none_or(|next| next > last_ps) {
            self.serial.byte()
        } else {
            self.byte_across_update(start_ps, bit_ps)
        };
        self.timeline.sclk_ps = end_ps;

        if let Some(din) = self.alignment.take(din) {
            self.decode(din, start_ps + bit_ps / 2, last_ps);
        }
        match self.stuck {
            Some((true, _)) => 0xFF,
            Some((false, _)) => 0x00,
            None => dout,
        }
    }

    /// Carries out a byte as the part has put it together, clocked from `first_ps` to `last_ps`.
    fn decode(&mut self, din: u8, first_ps: u64, last_ps: u64) {
        let byte = Byte {
            din,
            first_ps,
            last_ps,
        };
        let stopped = self.mode == ReadMode::Stopped;
        let (action, breach) = self.decoder.take(byte, stopped);
        if let Some(rule) = breach {
            self.breach(first_ps, rule);
        }
        self.act(action, last_ps);
    }

    /// The serial interface begins a new byte, and the next word from its highest bit.
    pub(super) fn realign(&mut self) {
        self.decoder.reset();
        self.alignment = Alignment::default();
        self.serial.slip = None;
    }

    /// A byte during which a word is made or DRDY falls: bit by bit.
    fn byte_across_update(&mut self, start_ps: u64, bit_ps: u64) -> u8 {
        let mut byte = 0;
        for bit in 0..8 {
            let rising_ps = start_ps + bit * bit_ps + bit_ps / 2;
            self.catch_up(rising_ps);
            byte = byte << 1 | u8::from(self.serial.bit());
            self.timeline.sclk_ps = rising_ps + bit_ps / 2;
        }
        byte
    }
}
