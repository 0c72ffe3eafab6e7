//! Two sectors of flash as the chip has them, in so far as something is kept there; power may be cut.

use crate::keep::{COPIES, NotWritten, Sectors, WORDS};

/// An erased word.
const BLANK: u32 = u32::MAX;

/// The sectors of a board without hardware.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VirtualFlash {
    sectors: [[u32; WORDS]; COPIES],
    /// Words that may still be erased or written until power goes; `None` if it stays.
    power: Option<u32>,
}

impl Default for VirtualFlash {
    fn default() -> Self {
        Self {
            sectors: [[BLANK; WORDS]; COPIES],
            power: None,
        }
    }
}

impl VirtualFlash {
    /// The same, whose power goes after so many words, each written or erased; `None` to stay on.
    #[must_use]
    pub fn cut_after(mut self, words: Option<u32>) -> Self {
        self.power = words;
        self
    }

    /// Clears bits of a word, as decay does.
    pub fn clear(&mut self, copy: usize, word: usize, bits: u32) {
        if let Some(word) = self.word(copy, word) {
            *word &= !bits;
        }
    }

    fn word(&mut self, copy: usize, word: usize) -> Option<&mut u32> {
        self.sectors.get_mut(copy)?.get_mut(word)
    }

    /// Takes the power that a word needs.
    fn spend(&mut self) -> Result<(), NotWritten> {
        match &mut self.power {
            None => Ok(()),
            Some(0) => Err(NotWritten),
            Some(left) => {
                *left -= 1;
                Ok(())
            }
        }
    }
}

impl Sectors for VirtualFlash {
    fn read(&self, copy: usize, word: usize) -> u32 {
        let sector = self.sectors.get(copy);
        sector
            .and_then(|sector| sector.get(word))
            .copied()
            .unwrap_or(BLANK)
    }

    fn erase(&mut self, copy: usize) -> Result<(), NotWritten> {
        for word in 0..WORDS {
            self.spend()?;
            *self.word(copy, word).ok_or(NotWritten)? = BLANK;
        }
        Ok(())
    }

    fn write(&mut self, copy: usize, word: usize, value: u32) -> Result<(), NotWritten> {
        self.spend()?;
        *self.word(copy, word).ok_or(NotWritten)? &= value;
        Ok(())
    }
}
