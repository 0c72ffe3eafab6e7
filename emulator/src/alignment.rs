//! The input register behind DIN: how bits become the bytes of commands, and how they slip.

use crate::Slip;

/// Counts the bits of DIN into bytes. Nothing marks where a byte begins: a clock too many or too
/// few shifts every byte that follows.
#[derive(Debug, Clone, Default)]
pub(crate) struct Alignment {
    slip: Option<Slip>,
    /// Bits of the byte before that wait for the rest of theirs, in the lowest places.
    held: u8,
    /// No byte is complete yet.
    empty: bool,
}

impl Alignment {
    /// As a slip between two bytes leaves it; DIN is low meanwhile.
    pub(crate) fn slipped(slip: Slip) -> Self {
        Self {
            slip: Some(slip),
            held: 0,
            empty: true,
        }
    }

    /// The byte that eight clocks complete, if they complete one. A missed clock delays the first
    /// byte until the next one begins; from then on each completes one.
    pub(crate) fn take(&mut self, din: u8) -> Option<u8> {
        let before = core::mem::replace(&mut self.held, din);
        let first = core::mem::take(&mut self.empty);
        match self.slip {
            None => Some(din),
            // The extra bit comes first, and the last one waits.
            Some(Slip::Early) => Some(before << 7 | din >> 1),
            // The first bit was not seen, and that of the next byte comes last.
            Some(Slip::Late) => (!first).then_some(before << 1 | din >> 7),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BYTES: [u8; 8] = [0x11, 0x21, 0x00, 0xFF, 0x06, 0x10, 0x80, 0x01];

    /// Bit `at` of what the part sees: [`BYTES`] without their first bit, or with one ahead.
    fn bit(slip: Option<Slip>, at: usize) -> u8 {
        let at = match slip {
            None => at,
            Some(Slip::Late) => at + 1,
            Some(Slip::Early) if at == 0 => return 0,
            Some(Slip::Early) => at - 1,
        };
        BYTES[at / 8] >> (7 - at % 8) & 1
    }

    #[test]
    fn bytes_are_what_the_bits_make_of_them() {
        for slip in [None, Some(Slip::Early), Some(Slip::Late)] {
            let mut alignment = slip.map_or_else(Alignment::default, Alignment::slipped);
            let taken = BYTES.iter().filter_map(|&byte| alignment.take(byte));
            let whole = if slip == Some(Slip::Late) { 7 } else { 8 };
            let expected = (0..whole).map(|byte| {
                (0..8).fold(0, |value, place| value << 1 | bit(slip, 8 * byte + place))
            });
            assert!(taken.eq(expected), "{slip:?}");
        }
    }
}
