//! The output register behind DOUT: how a word leaves, slips and tears.

/// A lasting shift of the words on DOUT by one bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slip {
    /// The first bit is lost, the rest come one bit early: the level doubles.
    Early,
    /// The level that stood on DOUT, the 33rd bit of the word before, comes first and the rest
    /// one bit late: the level halves.
    Late,
}

/// What an update in the middle of a read does to the word; SBAS378D page 24 says only that it is
/// overwritten.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tear {
    /// The bits not yet sent are those of the new word in their places: old high bits, new low
    /// bits.
    #[default]
    Splice,
    /// The register is loaded afresh: the bits that follow are the new word from its highest on.
    Reload,
}

/// The output shift register.
#[derive(Debug, Clone, Default)]
pub(crate) struct Serial {
    /// What is still to come, from the highest bit on; below it, zeros.
    bits: u64,
    /// How many bits are still to come.
    left: u32,
    /// Level of DOUT when nothing is left: the last bit of the word.
    last: bool,
    pub(crate) slip: Option<Slip>,
}

impl Serial {
    /// Level of DOUT now, ahead of the next SCLK.
    fn level(&self) -> bool {
        if self.left > 0 {
            self.bits >> 63 != 0
        } else {
            self.last
        }
    }

    /// Loads the next word.
    pub(crate) fn load(&mut self, word: u32) {
        let aligned = u64::from(word) << 32;
        (self.bits, self.left) = match self.slip {
            None => (aligned, 32),
            Some(Slip::Early) => (aligned << 1, 31),
            Some(Slip::Late) => (u64::from(self.level()) << 63 | aligned >> 1, 33),
        };
        self.last = word & 1 != 0;
    }

    /// Loads a word while one is being read.
    pub(crate) fn overwrite(&mut self, word: u32, tear: Tear) {
        if self.left == 0 || self.left >= 32 || tear == Tear::Reload {
            self.load(word);
        } else {
            self.bits = u64::from(word) << (64 - self.left);
            self.last = word & 1 != 0;
        }
    }

    /// As after power-on, but for the slip.
    pub(crate) fn clear(&mut self) {
        *self = Self {
            slip: self.slip,
            ..Self::default()
        };
    }

    /// Forgets what was to come.
    pub(crate) fn empty(&mut self) {
        self.left = 0;
    }

    /// One bit out.
    pub(crate) fn bit(&mut self) -> bool {
        let level = self.level();
        self.bits <<= 1;
        self.left = self.left.saturating_sub(1);
        level
    }

    /// Eight bits out.
    pub(crate) fn byte(&mut self) -> u8 {
        if self.left < 8 {
            return (0..8).fold(0, |byte, _| byte << 1 | u8::from(self.bit()));
        }
        let byte = (self.bits >> 56) as u8;
        self.bits <<= 8;
        self.left -= 8;
        byte
    }

    /// A register's contents, out through the same path.
    pub(crate) fn register(&mut self, value: u8) -> u8 {
        let byte = match self.slip {
            None => value,
            Some(Slip::Early) => value << 1 | value & 1,
            Some(Slip::Late) => u8::from(self.level()) << 7 | value >> 1,
        };
        self.left = 0;
        self.last = value & 1 != 0;
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OLD: u32 = 0xFFFF_0001;
    const NEW: u32 = 0x1234_5678;

    fn read(serial: &mut Serial) -> u32 {
        u32::from_be_bytes([(); 4].map(|()| serial.byte()))
    }

    #[test]
    fn a_word_goes_out_from_its_highest_bit_and_its_last_bit_stays() {
        let mut serial = Serial::default();
        serial.load(OLD);
        assert_eq!(read(&mut serial), OLD);
        assert_eq!(serial.byte(), 0xFF);
    }

    #[test]
    fn an_early_slip_doubles_and_a_late_one_halves() {
        for word in [0x1234_5678, 0xF234_5679_u32] {
            let mut serial = Serial {
                slip: Some(Slip::Early),
                ..Serial::default()
            };
            serial.load(word);
            assert_eq!(read(&mut serial), word << 1 | word & 1);

            let mut serial = Serial {
                slip: Some(Slip::Late),
                ..Serial::default()
            };
            for _ in 0..2 {
                serial.load(word);
                assert_eq!(read(&mut serial) & 0x7FFF_FFFF, word >> 1);
            }
            serial.load(word);
            // The stale level is the sign's repetition, so the halved word keeps its sign.
            assert_eq!(read(&mut serial) as i32, word as i32 >> 1);
        }
    }

    #[test]
    fn an_update_tears_the_word_in_either_way() {
        for (tear, torn) in [(Tear::Splice, 0xFFFF_5678), (Tear::Reload, 0xFFFF_1234)] {
            let mut serial = Serial::default();
            serial.load(OLD);
            let high = u16::from_be_bytes([serial.byte(), serial.byte()]);
            serial.overwrite(NEW, tear);
            let low = u16::from_be_bytes([serial.byte(), serial.byte()]);
            assert_eq!(u32::from(high) << 16 | u32::from(low), torn, "{tear:?}");
        }
    }
}
