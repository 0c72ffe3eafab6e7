//! The slots of the chip's flash. While a sector is erased or a word written the core stands still, since
//! its program is in the same flash.

use inm_firmware::keep::NotWritten;
use inm_firmware::update::{SLOT_WORDS, Slots};
use inm_protocol::slot::{BLANK, FLASH, SECTOR, SLOT_STARTS, SLOTS};
use stm32f4xx_hal::flash::{FlashExt, LockedFlash};
use stm32f4xx_hal::pac;

/// Bytes of a word.
const WORD: usize = size_of::<u32>();

/// Numbers of the sectors of each slot (RM0090, table 5).
const SECTORS: [[u8; 2]; SLOTS] = [[5, 6], [7, 8]];

/// The flash controller, for the slots.
pub struct Flash(LockedFlash);

impl Flash {
    /// Takes the controller; nothing is erased or written yet.
    pub fn new(controller: pac::FLASH) -> Self {
        Self(LockedFlash::new(controller))
    }

    /// Has data read from the cells from now on: what is written is read back at once, and a cache may hold
    /// what was there before (RM0090, 3.5.3).
    #[allow(unsafe_code)]
    pub fn bypass_cache(&mut self) {
        // SAFETY: the register belongs to the controller that this has, and nothing else runs.
        let registers = unsafe { &*pac::FLASH::ptr() };
        registers.acr().modify(|_, w| w.dcen().clear_bit());
    }
}

/// Where a word lies, bytes from the start of the flash.
fn place(slot: usize, word: usize) -> Option<usize> {
    let start = SLOT_STARTS.get(slot).filter(|_| word < SLOT_WORDS)?;
    Some((start - FLASH) as usize + WORD * word)
}

impl Slots for Flash {
    #[allow(unsafe_code)]
    fn read(&self, slot: usize, word: usize) -> u32 {
        let Some(place) = place(slot, word) else {
            return BLANK;
        };
        let address = self.0.address() + place;
        // SAFETY: the slots are flash of the chip, readable at any time but during an erase, for which this
        // program waits; the address is aligned, any bits are a word. Volatile, because erasing and writing
        // change it behind the compiler's back.
        unsafe { core::ptr::with_exposed_provenance::<u32>(address).read_volatile() }
    }

    /// A sector takes 2 s typically and 4 s at most, a byte at a time (STM32F405 data sheet, tERASE128KB, as
    /// remembered).
    fn erase(&mut self, slot: usize, words: usize) -> Result<(), NotWritten> {
        let sectors = SECTORS.get(slot).ok_or(NotWritten)?;
        let touched = (WORD * words).div_ceil(SECTOR as usize);
        for &sector in sectors.get(..touched).ok_or(NotWritten)? {
            let erased = self.0.unlocked().erase(sector);
            erased.map_err(|_| NotWritten)?;
        }
        Ok(())
    }

    fn write(&mut self, slot: usize, word: usize, value: u32) -> Result<(), NotWritten> {
        let place = place(slot, word).ok_or(NotWritten)?;
        let bytes = value.to_le_bytes();
        let written = self.0.unlocked().program(place, bytes.iter());
        written.map_err(|_| NotWritten)
    }
}
