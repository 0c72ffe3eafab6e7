//! The two sectors of flash that keep what stays while the board is off: the last two of the chip,
//! which memory.x leaves out of what the linker fills and `inm flash` writes to.
//!
//! The sectors of 16 KB would be erased sooner, but lie where the program begins. Not tried on hardware.

use inm_firmware::keep::{COPIES, NotWritten};
#[cfg(not(feature = "qemu"))]
use inm_protocol::slot;
use stm32f4xx_hal::flash::{FlashExt, LockedFlash};
use stm32f4xx_hal::pac::FLASH;

/// Numbers of the sectors and where they begin, bytes from the start of the flash (RM0090, table 5).
const SECTORS: [(u8, usize); COPIES] = [(10, 0xC_0000), (11, 0xE_0000)];

/// Bytes of a word.
const WORD: usize = size_of::<u32>();

/// Slot that this image is linked for.
#[cfg(not(feature = "qemu"))]
const SLOT: usize = cfg!(feature = "slot-b") as usize;

/// Words of a sector of 128 KB.
const SECTOR_WORDS: usize = 128 * 1024 / WORD;

/// The flash controller, in so far as something is kept.
pub struct Flash(LockedFlash);

impl Flash {
    /// Takes the controller; nothing is erased or written yet.
    pub fn new(controller: FLASH) -> Self {
        Self(LockedFlash::new(controller))
    }

    /// Notes down in the header of this image's slot that the program is sound, if it is not there yet: a
    /// word, for some 16 us of which the core stands still. A flash that does not take it is tried again at
    /// the next start.
    #[cfg(not(feature = "qemu"))]
    pub fn prove(&mut self) {
        let offset = slot::SLOT_STARTS[SLOT] - slot::FLASH + (WORD * slot::PROVED) as u32;
        if self.word(offset as usize) == slot::BLANK {
            let _ = self.put(offset as usize, 0);
        }
    }

    /// Writes a word of flash, by its place from the start in bytes.
    #[inline(never)]
    fn put(&mut self, offset: usize, value: u32) -> Result<(), NotWritten> {
        let bytes = value.to_le_bytes();
        let written = self.change(|flash| flash.unlocked().program(offset, bytes.iter()));
        written.map_err(|_| NotWritten)
    }

    /// Changes cells with the data cache off, and empties it before it is on again: it would go on saying what was
    /// read of them before (RM0090, 3.5.3). No instruction lies in them.
    #[allow(unsafe_code)]
    fn change<T>(&mut self, work: impl FnOnce(&mut LockedFlash) -> T) -> T {
        // SAFETY: the register belongs to the controller that this has; the start-up code, which set it up, does not
        // touch it any more, and no interrupt does.
        let access = unsafe { &*FLASH::ptr() }.acr();
        access.modify(|_, w| w.dcen().clear_bit());
        let done = work(&mut self.0);
        // It can be emptied only while it is off.
        access.modify(|_, w| w.dcrst().set_bit());
        access.modify(|_, w| w.dcrst().clear_bit());
        access.modify(|_, w| w.dcen().set_bit());
        done
    }

    /// A word of flash, by its place from the start in bytes, a multiple of four.
    #[allow(unsafe_code)]
    fn word(&self, offset: usize) -> u32 {
        let address = self.0.address() + offset;
        // SAFETY: both callers stay within the flash of the chip, readable at any time but during an erase,
        // for which this program waits; the address is aligned, any bits are a word. Volatile, because
        // erasing and writing change it behind the compiler's back.
        unsafe { core::ptr::with_exposed_provenance::<u32>(address).read_volatile() }
    }

    /// A word of a copy; all ones beyond its sector.
    pub fn read(&self, copy: usize, word: usize) -> u32 {
        let Some((_, start)) = SECTORS.get(copy).filter(|_| word < SECTOR_WORDS) else {
            return u32::MAX;
        };
        self.word(start + WORD * word)
    }

    /// Erases the sector of a copy: 2 s typically and 4 s at most, a byte at a time (STM32F405 data sheet,
    /// tERASE128KB, as remembered).
    pub fn erase(&mut self, copy: usize) -> Result<(), NotWritten> {
        let (sector, _) = SECTORS.get(copy).ok_or(NotWritten)?;
        let erased = self.change(|flash| flash.unlocked().erase(*sector));
        erased.map_err(|_| NotWritten)
    }

    /// Writes a word of a copy whose sector is erased.
    pub fn write(&mut self, copy: usize, word: usize, value: u32) -> Result<(), NotWritten> {
        let (_, start) = SECTORS.get(copy).ok_or(NotWritten)?;
        self.put(start + WORD * word, value)
    }
}
