//! An image for the flash: refused with a reason, or all of it in the chip's flash, nothing twice.

use std::ops::Range;

use inm_host::internals::flash::Image;

/// The flash for programs of an STM32F405RG (RM0090, table 5), as a test states it anew.
const FLASH: Range<u64> = 0x0800_0000..0x0810_0000;

/// Reads `bytes` as `inm flash --dry-run` does.
pub fn keeps(bytes: &[u8]) {
    let image = match Image::parse(bytes) {
        Ok(image) => image,
        Err(problem) => return assert!(!problem.to_string().is_empty()),
    };
    let mut free = FLASH.start;
    for (address, bytes) in &image.segments {
        assert!(*address >= free, "{address:#x} below {free:#x}");
        free = address + bytes.len() as u64;
        assert!(free <= FLASH.end, "{free:#x}");
    }
    assert!(!image.is_empty());
}
