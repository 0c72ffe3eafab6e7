//! The flash controller (RM0090, 3.6 to 3.9): keys, one word of control, sectors that are erased, and what its data cache
//! may still hold of cells that have changed (3.5.3). The bytes themselves lie in the machine's memory.

use std::ops::Range;

use super::Registers;

const ACR: u32 = 0x00;
const KEYR: u32 = 0x04;
const SR: u32 = 0x0c;
const CR: u32 = 0x10;

/// Bits of ACR (3.9.1): the data cache is on, is emptied.
const DCEN: u32 = 1 << 10;
const DCRST: u32 = 1 << 12;

/// Keys that unlock CR, in this order (RM0090, 3.6.1).
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Bits of CR (RM0090, 3.9.5): programming, sector erase, start, lock; the sector's number.
const PG: u32 = 1 << 0;
const SER: u32 = 1 << 1;
const STRT: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;
const SECTOR_SHIFT: u32 = 3;
const SECTOR_MASK: u32 = 0x1f;

/// Typical times with bytes at a time (STM32F405 data sheet, flash characteristics, as remembered): a byte,
/// and a KB of a sector.
const BYTE_PS: u64 = 16_000_000;
const ERASE_PS_PER_KB: u64 = 2_000_000_000_000 / 128;

/// The controller.
pub struct Flash {
    registers: Registers,
    /// Keys that came in their order.
    keys: usize,
    /// A sector that is to be erased: bytes from the start of the flash.
    erase: Option<Range<u32>>,
    /// Cells that have changed since the cache was last emptied, bytes from the start of the flash.
    changed: Vec<Range<u32>>,
    /// It was emptied while it was on, which the manual forbids.
    pub(crate) emptied_while_on: bool,
}

impl Flash {
    pub(super) fn new() -> Self {
        let mut registers = Registers::default();
        registers.set(CR, LOCK);
        Self {
            registers,
            keys: 0,
            erase: None,
            changed: Vec::new(),
            emptied_while_on: false,
        }
    }

    pub(super) fn get(&self, offset: u32) -> u32 {
        match offset {
            // The core stands still while it is busy, and so never sees it.
            SR => 0,
            _ => self.registers.get(offset),
        }
    }

    pub(super) fn set(&mut self, offset: u32, value: u32) {
        match offset {
            KEYR if KEYS.get(self.keys) == Some(&value) => {
                self.keys += 1;
                if self.keys == KEYS.len() {
                    self.registers.set(CR, self.registers.get(CR) & !LOCK);
                }
            }
            // A wrong key locks it until a reset.
            KEYR => self.keys = KEYS.len() + 1,
            ACR => {
                let emptied = value & DCRST != 0;
                let on = (value | self.registers.get(ACR)) & DCEN != 0;
                self.emptied_while_on |= emptied && on;
                if emptied && !on {
                    self.changed.clear();
                }
                self.registers.set(ACR, value);
            }
            CR if self.is_locked() => {}
            CR => {
                if value & LOCK != 0 {
                    self.keys = 0;
                }
                if value & STRT != 0 && value & SER != 0 {
                    self.erase = sector(value >> SECTOR_SHIFT & SECTOR_MASK);
                }
                self.registers.set(CR, value & !STRT);
            }
            _ => self.registers.set(offset, value),
        }
    }

    fn is_locked(&self) -> bool {
        self.registers.get(CR) & LOCK != 0
    }

    /// Whether a byte may be programmed now.
    pub(crate) fn programs(&self) -> bool {
        !self.is_locked() && self.registers.get(CR) & (PG | SER) == PG
    }

    /// The sector that is to be erased, once.
    pub(crate) fn take_erase(&mut self) -> Option<Range<u32>> {
        self.erase.take()
    }

    /// Cells have changed, bytes from the start of the flash.
    pub(crate) fn change(&mut self, cells: Range<u32>) {
        match self.changed.last_mut() {
            // Byte by byte.
            Some(last) if last.end == cells.start => last.end = cells.end,
            _ => self.changed.push(cells),
        }
    }

    /// Whether the cache may say what a cell held before.
    pub(crate) fn may_be_stale(&self, at: u32) -> bool {
        self.registers.get(ACR) & DCEN != 0 && self.changed.iter().any(|cells| cells.contains(&at))
    }

    /// How long the core stands still for so many bytes programmed.
    pub(crate) fn programming_ps(bytes: usize) -> u64 {
        bytes as u64 * BYTE_PS
    }

    /// How long it stands still for a sector erased.
    pub(crate) fn erasing_ps(sector: &Range<u32>) -> u64 {
        u64::from(sector.end - sector.start) / 1024 * ERASE_PS_PER_KB
    }
}

/// Where a sector lies, bytes from the start of the flash (RM0090, table 5).
fn sector(number: u32) -> Option<Range<u32>> {
    const KB: u32 = 1024;
    let (start, len) = match number {
        0..4 => (16 * KB * number, 16 * KB),
        4 => (64 * KB, 64 * KB),
        5..12 => (128 * KB * (number - 4), 128 * KB),
        _ => return None,
    };
    Some(start..start + len)
}
