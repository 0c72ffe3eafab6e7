//! Where in the flash loader and programs lie, and the header that says whether a slot holds a program.
//!
//! ```text
//!   sector   address                  what
//!   0        0800 0000   16 KB        the loader
//!   1 to 4   0800 4000   112 KB       nothing
//!   5, 6     0802 0000   256 KB       slot 0: header of 512 bytes, program
//!   7, 8     0806 0000   256 KB       slot 1: the same
//!   9        080A 0000   128 KB       nothing
//!   10, 11   080C 0000   256 KB       what the program keeps while the board is off
//! ```
//!
//! (RM0090, table 5.) The header is frozen like the [messages](crate::update) of the loader: a loader of any
//! release starts programs of any other. A program is linked for its slot, since it runs where it lies.

use core::ops::Range;

/// Programs that the flash holds.
pub const SLOTS: usize = 2;

/// Where the flash begins, and the loader in it.
pub const FLASH: u32 = 0x0800_0000;

/// The loader: the first sector.
pub const LOADER_PLACE: Range<u32> = FLASH..FLASH + 16 * 1024;

/// Bytes of a sector that a slot is made of.
pub const SECTOR: u32 = 128 * 1024;

/// Bytes of a slot: two sectors, some three times what a program takes.
pub const SLOT: u32 = 2 * SECTOR;

/// Where the slots begin.
pub const SLOT_STARTS: [u32; SLOTS] = [FLASH + SECTOR, FLASH + SECTOR + SLOT];

/// Bytes ahead of a program. Its vector table lies behind them, and must be aligned to 512 bytes (PM0214,
/// 4.4.4, with the 98 vectors of this chip).
pub const HEADER: u32 = 512;

/// Most bytes of a program.
pub const ROOM: u32 = SLOT - HEADER;

/// Words of a header that say which program it is; the last is written last, and is their checksum.
pub const HEADER_WORDS: usize = 5;

/// Word of a header that the program writes once it has proved itself; blank before.
pub const PROVED: usize = HEADER_WORDS;

/// Words of a header that are used up by the starts of a program that has not proved itself: four, since
/// two may be a supply that comes up in steps and a third somebody's hand.
pub const TRIES: Range<usize> = PROVED + 1..PROVED + 5;

/// What flash holds where nothing was written.
pub const BLANK: u32 = u32::MAX;

/// Begins a header: `INM`, and the version of this layout.
const MAGIC: u32 = u32::from_be_bytes(*b"INM\x02");

/// What a header says of the program behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// Of two programs the one with the larger number is the newer; it may begin anew behind the largest.
    pub number: u32,
    /// Bytes of the program; a multiple of four.
    pub length: u32,
    /// CRC-32 of the frames, over them.
    pub crc: u32,
}

impl Header {
    /// The words that say so, without [`PROVED`] and [`TRIES`].
    #[must_use]
    pub fn words(self) -> [u32; HEADER_WORDS] {
        let Self {
            number,
            length,
            crc,
        } = self;
        let said = [MAGIC, number, length, crc];
        [MAGIC, number, length, crc, crc32_of_words(said)]
    }

    /// Reads the words at the start of a slot; `None` if they are no header.
    #[must_use]
    pub fn read(words: [u32; HEADER_WORDS]) -> Option<Self> {
        let [_, number, length, crc, _] = words;
        let header = Self {
            number,
            length,
            crc,
        };
        let sound = header.words() == words && length > 0 && length <= ROOM;
        (sound && length.is_multiple_of(4)).then_some(header)
    }

    /// Whether this program is newer than another one.
    #[must_use]
    pub fn is_newer(self, other: Self) -> bool {
        self.number.wrapping_sub(other.number).cast_signed() > 0
    }
}

/// CRC-32 of the frames, over words of flash as they lie there.
pub fn crc32_of_words(words: impl IntoIterator<Item = u32>) -> u32 {
    let mut digest = crate::frame::CRC.digest();
    for word in words {
        digest.update(&word.to_le_bytes());
    }
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crc32;

    #[test]
    fn a_header_that_lost_a_bit_is_none() {
        let header = Header {
            number: 7,
            length: 83_000,
            crc: 0x1234_5678,
        };
        let words = header.words();
        assert_eq!(Header::read(words), Some(header));
        for bit in 0..32 * HEADER_WORDS {
            let mut damaged = words;
            damaged[bit / 32] ^= 1 << (bit % 32);
            assert_eq!(Header::read(damaged), None, "bit {bit}");
        }
        assert_eq!(Header::read([BLANK; HEADER_WORDS]), None);
        assert_eq!(Header::read([0; HEADER_WORDS]), None);
    }

    #[test]
    fn a_header_of_a_length_that_no_slot_holds_is_none() {
        for (length, sound) in [
            (0, false),
            (4, true),
            (6, false),
            (ROOM, true),
            (ROOM + 4, false),
        ] {
            let header = Header {
                number: 1,
                length,
                crc: 0,
            };
            assert_eq!(Header::read(header.words()).is_some(), sound, "{length}");
        }
    }

    #[test]
    fn numbers_begin_anew_behind_the_largest() {
        let header = |number| Header {
            number,
            length: 4,
            crc: 0,
        };
        assert!(header(2).is_newer(header(1)) && !header(1).is_newer(header(2)));
        assert!(header(0).is_newer(header(u32::MAX)) && !header(5).is_newer(header(5)));
    }

    #[test]
    fn words_are_summed_as_they_lie_in_flash() {
        let sum = crc32_of_words([u32::from_le_bytes(*b"1234"), u32::from_le_bytes(*b"5678")]);
        assert_eq!(sum, crc32(b"12345678"));
    }
}
