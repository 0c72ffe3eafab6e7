//! Programs in two slots: which one starts, and how a new one comes in over the serial line.
//!
//! ```text
//!   start   --> first_to_start --> one try used, unless it has proved itself --> it runs
//!   line    --> Loader::take: frames, the hello; when nobody speaks any more, on to the start
//!   ToLoader --> Updater::answer --> erase the free slot, write, verify, header last --> FromLoader
//! ```
//!
//! The slot of the program that starts is never touched, and the other one counts only with its header,
//! which is written last: power may go at any word, and what starts afterwards is the old program or the
//! new one, whole. The program that was replaced stays where it is until the next update, so that a new one
//! that does not prove itself in a few starts is left for it.
//!
//! Nothing here knows a chip; the loader of the image, the virtual board and the tests bring their flash.

mod listen;
mod receive;

pub use listen::{Loader, SILENCE_MS};
pub use receive::Updater;

use inm_protocol::slot::crc32_of_words;
use inm_protocol::slot::{BLANK, HEADER, Header, PROVED, SLOT, SLOTS, TRIES};

use crate::keep::NotWritten;

/// Bytes of a word.
const WORD: usize = size_of::<u32>();

/// Words of a slot.
pub const SLOT_WORDS: usize = SLOT as usize / WORD;

/// Words ahead of a program.
pub const PROGRAM_AT: usize = HEADER as usize / WORD;

/// What a program leaves in a word of RAM that survives a reset, to ask for the loader. After power-on that
/// word holds anything, and this by a chance of one in 2^32, which costs the loader's patience.
pub const ASKED: u32 = u32::from_be_bytes(*b"load");

/// Two slots of flash: what is erased is all ones, and writing only clears bits.
pub trait Slots {
    /// A word of a slot, by its number from the slot's start; all ones beyond its end.
    fn read(&self, slot: usize, word: usize) -> u32;

    /// Erases the first sectors of a slot, those with its first `words`; the first sector first.
    ///
    /// # Errors
    /// [`NotWritten`] if the flash says so.
    fn erase(&mut self, slot: usize, words: usize) -> Result<(), NotWritten>;

    /// Writes a word of a slot.
    ///
    /// # Errors
    /// [`NotWritten`] if the flash says so.
    fn write(&mut self, slot: usize, word: usize, value: u32) -> Result<(), NotWritten>;
}

/// Words of the program in a slot.
fn program(slots: &dyn Slots, slot: usize, length: u32) -> impl Iterator<Item = u32> {
    let words = PROGRAM_AT..PROGRAM_AT + length as usize / WORD;
    words.map(move |word| slots.read(slot, word))
}

/// What the header of a slot says, whatever is behind it.
fn header(slots: &dyn Slots, slot: usize) -> Option<Header> {
    Header::read(core::array::from_fn(|word| slots.read(slot, word)))
}

/// What the header of a slot says, if the program behind it is whole, to the bit.
pub fn whole(slots: &dyn Slots, slot: usize) -> Option<Header> {
    let header = header(slots, slot)?;
    let found = crc32_of_words(program(slots, slot, header.length));
    (found == header.crc).then_some(header)
}

/// The slots, that of the newer header first.
fn by_age(slots: &dyn Slots) -> [usize; SLOTS] {
    match [0, 1].map(|slot| header(slots, slot)) {
        [Some(first), Some(second)] if second.is_newer(first) => [1, 0],
        [None, Some(_)] => [1, 0],
        _ => [0, 1],
    }
}

/// The slot of the newest program that is whole.
fn newest(slots: &dyn Slots) -> Option<usize> {
    by_age(slots)
        .into_iter()
        .find(|&slot| whole(slots, slot).is_some())
}

/// Whether the program of a slot has proved itself. Power that went while it was written leaves some bits
/// cleared, which will do.
fn has_proved(slots: &dyn Slots, slot: usize) -> bool {
    slots.read(slot, PROVED) != BLANK
}

/// The word that the next start of a program uses up; `None` if all are.
fn next_try(slots: &dyn Slots, slot: usize) -> Option<usize> {
    TRIES
        .into_iter()
        .find(|&word| slots.read(slot, word) == BLANK)
}

/// The slot whose program is to be started: the newest that is whole and has proved itself, or may still
/// try. No program is summed up in vain, which takes a start's time.
pub fn first_to_start(slots: &dyn Slots) -> Option<usize> {
    let may_start = |&slot: &usize| {
        (has_proved(slots, slot) || next_try(slots, slot).is_some()) && whole(slots, slot).is_some()
    };
    by_age(slots).into_iter().find(may_start)
}

/// The slot to start now, one of its tries used up. Where the flash does not take that, it starts all the
/// same: a program that may be bad is better than none.
pub fn start(slots: &mut dyn Slots) -> Option<usize> {
    let slot = first_to_start(slots)?;
    if !has_proved(slots, slot)
        && let Some(word) = next_try(slots, slot)
    {
        let _ = slots.write(slot, word, 0);
    }
    Some(slot)
}

/// The other slot.
const fn other(slot: usize) -> usize {
    SLOTS - 1 - slot
}
