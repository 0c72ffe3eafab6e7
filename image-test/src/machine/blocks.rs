//! Counting instructions, and everything that happens between them.
//!
//! The engine tells of each straight run of instructions, a block, just before it is executed. Exceptions
//! are let in there: none comes later than a block's end, some ten instructions.

use unicorn_engine::Unicorn;

use super::exceptions;
use crate::chip::Chip;
use crate::image::{FLASH, Image};

/// How many instructions a block of the flash has, worked out when it is first met.
pub struct Blocks {
    flash: Vec<u8>,
    /// By half the offset in the flash: bytes and instructions of the block that begins there.
    known: Vec<(u32, u32)>,
}

impl Blocks {
    /// Nothing met so far.
    pub fn new(image: &Image) -> Self {
        Self {
            flash: image.flash.clone(),
            known: vec![(0, 0); image.flash.len() / 2],
        }
    }

    /// Instructions in `size` bytes from `address` on.
    fn instructions(&mut self, address: u64, size: u32) -> u64 {
        let at = (address - u64::from(FLASH)) as usize;
        let (known_size, known) = self.known[at / 2];
        if known_size == size {
            return u64::from(known);
        }
        let mut count = 0;
        let mut offset = at;
        while offset < at + size as usize {
            // Five ones, or four and a zero ahead of another one, begin 32 bits (ARMv7-M, A5.1).
            let long = self.flash[offset + 1] >> 3 >= 0b11101;
            offset += if long { 4 } else { 2 };
            count += 1;
        }
        self.known[at / 2] = (size, count);
        u64::from(count)
    }
}

/// Has the engine call at each block.
pub fn count(uc: &mut Unicorn<'static, Chip>, mut blocks: Blocks) {
    uc.add_block_hook(1, 0, move |uc, address, size| {
        let chip = uc.get_data_mut();
        chip.catch_up_if_due();
        if chip.stop.is_some() {
            // Before the block: it is executed when the machine goes on.
            uc.emu_stop().expect("it runs");
        } else if !(chip.attention && exceptions::take(uc, address)) {
            let instructions = blocks.instructions(address, size);
            uc.get_data_mut().spend(instructions);
        }
    })
    .expect("the engine has blocks");
}
