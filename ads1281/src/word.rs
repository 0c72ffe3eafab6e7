//! One 32-bit word: its value, and what its redundant sign bit tells.
//!
//! Behind the FIR filter the word is 31 bits of value and, as its lowest bit, the sign once
//! more. The part inverts that bit when it clips: 7FFFFFFFh and 80000000h (SBAS378D, page 24).
//! On any other word a lowest bit unlike the sign means that the word was torn or shifted
//! while it was read. The reverse proves nothing: a signal with a constant offset keeps its
//! sign, and the rule catches between none and half of such words.

use super::register::Output;

/// A word as it was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Word(pub u32);

/// What the redundant sign bit says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Sign {
    /// It repeats the sign.
    Good,
    /// It is inverted, at full scale: the converter clipped.
    OverRange,
    /// It is inverted anywhere else: this is no word of the converter.
    Broken,
}

impl Word {
    /// The word that the four bytes on DOUT make, MSB first.
    pub const fn from_bytes(bytes: [u8; 4]) -> Self {
        Self(u32::from_be_bytes(bytes))
    }

    /// All 32 bits as a number: twice the [value](Self::value), with the sign in its lowest bit.
    pub const fn signed(self) -> i32 {
        self.0.cast_signed()
    }

    /// 31-bit value, in steps of VREF / (2 (2^30 - 1)) behind the FIR filter.
    pub const fn value(self) -> i32 {
        self.0.cast_signed() >> 1
    }

    /// The redundant sign bit's verdict. Only FIR data have one.
    pub const fn sign(self, output: Output) -> Sign {
        if matches!(output, Output::Modulator | Output::Sinc) || self.0 & 1 == self.0 >> 31 {
            return Sign::Good;
        }
        match self.0 {
            0x7FFF_FFFF | 0x8000_0000 => Sign::OverRange,
            _ => Sign::Broken,
        }
    }

    /// Whether all bits are the same: `Some(true)` for ones, `Some(false)` for zeros.
    pub const fn uniform(self) -> Option<bool> {
        match self.0 {
            0 => Some(false),
            u32::MAX => Some(true),
            _ => None,
        }
    }
}

/// One word with the circumstances of its reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reading {
    /// The word.
    pub word: Word,
    /// DRDY fell between the first clock and the last: the converter may have put the next
    /// word in place of the rest of this one.
    pub torn: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes of SBAS378D, page 24.
    #[test]
    fn the_table_of_ideal_codes() {
        for (word, value, sign) in [
            (0x7FFF_FFFF, 0x3FFF_FFFF, Sign::OverRange),
            (0x7FFF_FFFE, 0x3FFF_FFFF, Sign::Good),
            (0x0000_0000, 0, Sign::Good),
            (0xFFFF_FFFF, -1, Sign::Good),
            (0x8000_0001, -0x4000_0000, Sign::Good),
            (0x8000_0000, -0x4000_0000, Sign::OverRange),
            (0x0000_0001, 0, Sign::Broken),
            (0xFFFF_FFFE, -1, Sign::Broken),
        ] {
            let word = Word(word);
            assert_eq!(word.value(), value, "{word:x?}");
            assert_eq!(word.sign(Output::Fir), sign, "{word:x?}");
            assert_eq!(word.sign(Output::Sinc), Sign::Good, "{word:x?}");
        }
    }
}
