//! Where in the chip an image may lie.

use std::ops::Range;

use inm_protocol::slot::{FLASH, LOADER_PLACE, SLOT, SLOT_STARTS, SLOTS};

/// The first address behind the slots.
const SLOTS_END: u64 = (SLOT_STARTS[SLOTS - 1] + SLOT) as u64;

/// The loader's sector, and the slots for programs: all that is written to.
pub const PLACES: [Range<u64>; 1 + SLOTS] = [
    wide(LOADER_PLACE.start, LOADER_PLACE.end),
    wide(SLOT_STARTS[0], SLOT_STARTS[0] + SLOT),
    wide(SLOT_STARTS[1], SLOT_STARTS[1] + SLOT),
];

/// The RAM of 128 KB that stack and variables are in.
pub const RAM: Range<u64> = 0x2000_0000..0x2002_0000;

/// What else there is, with what writing there would do (RM0090, table 5 and sections 2.3 and 3.6).
const ELSEWHERE: [(Range<u64>, &str); 10] = [
    (wide(0, FLASH), "below the flash"),
    (
        wide(LOADER_PLACE.end, SLOT_STARTS[0]),
        "between the loader and the programs, which is kept free",
    ),
    (
        SLOTS_END..0x080c_0000,
        "behind the programs, which is kept free",
    ),
    (
        0x080c_0000..0x0810_0000,
        "the sectors in which the board keeps its calibration",
    ),
    (
        0x0810_0000..0x1000_0000,
        "beyond the end of the flash, which has 1 MB",
    ),
    (
        0x1fff_0000..0x1fff_7800,
        "the chip's own loader, which cannot be written",
    ),
    (
        0x1fff_7800..0x1fff_7a10,
        "the one-time programmable area, which can never be erased",
    ),
    (
        0x1fff_c000..0x1fff_c010,
        "the option bytes, which can lock the chip for ever",
    ),
    (RAM, "the RAM, which is lost when the board restarts"),
    (
        0x1000_0000..0x1001_0000,
        "the core-coupled RAM, which is lost when the board restarts",
    ),
];

/// Addresses of 32 bits among those of an ELF file.
const fn wide(start: u32, end: u32) -> Range<u64> {
    start as u64..end as u64
}

/// What lies at an address where a segment may not reach, in words.
pub fn place(address: u64) -> &'static str {
    if PLACES.iter().any(|place| place.contains(&address)) {
        return "the place of another part of the image";
    }
    let there = ELSEWHERE.iter().find(|(range, _)| range.contains(&address));
    there.map_or("no memory of the chip", |(_, what)| what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_is_that_of_the_linker() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/memory.x");
        let text = std::fs::read_to_string(path).expect("the memory map");
        // The stack lies at the start of the RAM, the variables at its end.
        let stack = format!("STACK : ORIGIN = {:#010x}, LENGTH = 32K", RAM.start);
        let variables = format!(
            "RAM   : ORIGIN = {:#010x}, LENGTH = 96K",
            RAM.start + 0x8000
        );
        assert!(text.contains(&stack) && text.contains(&variables), "{text}");
        assert_eq!(RAM.end - RAM.start, (32 + 96) * 1024);
    }

    #[test]
    fn no_address_of_the_flash_is_without_a_word() {
        for address in (0..0x0810_0000).step_by(0x4000) {
            assert_ne!(place(address), "no memory of the chip", "{address:#x}");
        }
    }
}
