//! Two slots of flash as the chip has them; power may be cut, in the middle of a word as well.

use inm_protocol::slot::{BLANK, SECTOR, SLOTS};

use crate::keep::NotWritten;
use crate::update::{SLOT_WORDS, Slots};

/// Words of a sector.
const SECTOR_WORDS: usize = SECTOR as usize / size_of::<u32>();

/// The slots of a board without hardware, in memory that somebody else has: [`VirtualSlots::WORDS`] words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VirtualSlots<M> {
    words: M,
    /// Words that may still change until power goes; `None` if it stays.
    power: Option<u32>,
    /// Bits of the word that was changing when power went which stayed as they were.
    torn: u32,
    /// Power went.
    dark: bool,
}

impl<M> VirtualSlots<M> {
    /// Words of both.
    pub const WORDS: usize = SLOTS * SLOT_WORDS;

    /// What `words` hold.
    pub fn new(words: M) -> Self {
        Self {
            words,
            power: None,
            torn: BLANK,
            dark: false,
        }
    }

    /// The same, whose power goes after so many words have changed, each written or erased; `None` to stay
    /// on. Of the word that is changing then, the bits `torn` stay as they were.
    #[must_use]
    pub fn cut_after(mut self, words: Option<u32>, torn: u32) -> Self {
        (self.power, self.torn, self.dark) = (words, torn, false);
        self
    }

    /// Whether power went.
    pub fn is_dark(&self) -> bool {
        self.dark
    }
}

impl<M: AsRef<[u32]> + AsMut<[u32]>> VirtualSlots<M> {
    /// The words of a slot.
    pub fn slot(&self, slot: usize) -> &[u32] {
        let mut slots = self.words.as_ref().chunks_exact(SLOT_WORDS);
        slots.nth(slot).unwrap_or_default()
    }

    /// Gives a word this value, unless it has it.
    fn change(&mut self, slot: usize, word: usize, value: u32) -> Result<(), NotWritten> {
        let mut slots = self.words.as_mut().chunks_exact_mut(SLOT_WORDS);
        let place = slots.nth(slot).and_then(|words| words.get_mut(word));
        let place = place.ok_or(NotWritten)?;
        match &mut self.power {
            _ if *place == value => {}
            None => *place = value,
            Some(0) => {
                *place = *place & self.torn | value & !self.torn;
                // Once only: there is no power any more.
                (self.torn, self.dark) = (BLANK, true);
                return Err(NotWritten);
            }
            Some(left) => {
                *left -= 1;
                *place = value;
            }
        }
        Ok(())
    }
}

impl<M: AsRef<[u32]> + AsMut<[u32]>> Slots for VirtualSlots<M> {
    fn read(&self, slot: usize, word: usize) -> u32 {
        self.slot(slot).get(word).copied().unwrap_or(BLANK)
    }

    fn erase(&mut self, slot: usize, words: usize) -> Result<(), NotWritten> {
        for word in 0..words.next_multiple_of(SECTOR_WORDS) {
            self.change(slot, word, BLANK)?;
        }
        Ok(())
    }

    fn write(&mut self, slot: usize, word: usize, value: u32) -> Result<(), NotWritten> {
        let value = self.read(slot, word) & value;
        self.change(slot, word, value)
    }
}
