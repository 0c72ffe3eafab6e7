//! The bytes of the flash: programmed by writing to them, erased by their controller.
//!
//! The engine keeps what it has translated of a program: one that is replaced by other bytes under way would
//! not be seen, so the tests write what was there before.

use unicorn_engine::{HookType, Unicorn};

use super::{Machine, RAM, RAM_LEN, exceptions};
use crate::chip::Chip;
use crate::chip::flash::Flash;
use crate::chip::rcc::Cause;
use crate::image::{FLASH, FLASH_LEN};

/// Has writes to the flash, which the engine's map does not allow, clear bits where the controller lets
/// them.
pub fn program(uc: &mut Unicorn<'static, Chip>) {
    let (begin, end) = (u64::from(FLASH), u64::from(FLASH) + FLASH_LEN as u64 - 1);
    let hook = |uc: &mut Unicorn<'_, Chip>, _, at: u64, len: usize, value: i64| {
        let chip = uc.get_data_mut();
        if !chip.flash.programs() || len != 1 {
            // PSIZE is a byte: anything else is an error of the sequence (RM0090, 3.6.4).
            chip.note(format!(
                "{len} bytes written to the flash at {at:#010x}, which does not take them"
            ));
            return true;
        }
        let mut byte = [0];
        uc.mem_read(at, &mut byte).expect("memory is there");
        let new = byte[0] & value as u8;
        if new != value as u8 {
            let what = format!("{value:02x} written to the flash over {:02x}", byte[0]);
            uc.get_data_mut().note(what);
        }
        uc.mem_write(at, &[new]).expect("memory is there");
        let place = (at - u64::from(FLASH)) as u32;
        uc.get_data_mut().flash.change(place..place + 1);
        uc.get_data_mut().stand_still(Flash::programming_ps(len));
        true
    };
    uc.add_mem_hook(HookType::MEM_WRITE_PROT, begin, end, hook)
        .expect("the engine has it");
}

/// Erases the sector that the controller was told to.
pub fn erase(uc: &mut Unicorn<'_, Chip>) {
    let Some(sector) = uc.get_data_mut().flash.take_erase() else {
        return;
    };
    let blank = vec![0xff; sector.len()];
    let at = u64::from(FLASH + sector.start);
    uc.mem_write(at, &blank).expect("memory is there");
    uc.get_data_mut().flash.change(sector.clone());
    uc.get_data_mut().stand_still(Flash::erasing_ps(&sector));
}

/// The last two sectors, of what the board keeps. Not the slots: the engine loses its place in a program that sums them
/// up while somebody looks, and the loader has the cache off.
const LOOKED_AT: u32 = FLASH + 0xC_0000;

/// Notes where data are read that the cache may hold as they were.
pub fn read(uc: &mut Unicorn<'static, Chip>) {
    let end = u64::from(FLASH) + FLASH_LEN as u64 - 1;
    let hook = |uc: &mut Unicorn<'_, Chip>, _, at: u64, _, _| {
        let chip = uc.get_data_mut();
        if chip.flash.may_be_stale((at - u64::from(FLASH)) as u32) {
            chip.note(format!(
                "flash read at {at:#010x} through a cache that may hold what was there before"
            ));
        }
        true
    };
    uc.add_mem_hook(HookType::MEM_READ, LOOKED_AT.into(), end, hook)
        .expect("the engine has it");
}

impl Machine {
    /// Power goes off and comes on again: the flash keeps what it holds, the RAM holds anything.
    pub fn power_off_and_on(&mut self) {
        self.poke(RAM as u32, &vec![0xa5; RAM_LEN as usize]);
        self.reset(Cause::Power);
    }

    /// The word at an address of the memory.
    #[must_use]
    pub fn word(&self, address: u32) -> u32 {
        exceptions::read_word(&self.uc, u64::from(address)) as u32
    }
}
