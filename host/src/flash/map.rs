//! Where in the chip an image may lie.

use std::ops::Range;

use super::FLASH_ORIGIN;

/// The flash for programs: 1 MB on an STM32F405RG (RM0090, table 5) without its last two sectors of 128 KB,
/// in which the board keeps its calibration.
pub const FLASH: Range<u64> = FLASH_ORIGIN..FLASH_ORIGIN + 768 * 1024;

/// The RAM of 128 KB that stack and variables are in.
pub const RAM: Range<u64> = 0x2000_0000..0x2002_0000;

/// What else there is, with what writing there would do (RM0090, table 5 and sections 2.3 and 3.6).
const ELSEWHERE: [(Range<u64>, &str); 8] = [
    (0..FLASH_ORIGIN, "below the flash"),
    (
        FLASH.end..FLASH_ORIGIN + (1 << 20),
        "the sectors in which the board keeps its calibration",
    ),
    (
        FLASH_ORIGIN + (1 << 20)..0x1000_0000,
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

/// What lies at an address outside of the flash, in words.
pub fn place(address: u64) -> &'static str {
    let there = ELSEWHERE.iter().find(|(range, _)| range.contains(&address));
    there.map_or("no memory of the chip", |(_, what)| what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_is_that_of_the_linker() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../memory.x");
        let text = std::fs::read_to_string(path).expect("the memory map");
        let flash = format!("FLASH : ORIGIN = {:#010x}, LENGTH = 768K", FLASH.start);
        assert!(text.contains(&flash), "{text}");
        assert_eq!(FLASH.end - FLASH.start, 768 * 1024);
        // The stack lies at the start of the RAM, the variables at its end.
        let stack = format!("STACK : ORIGIN = {:#010x}, LENGTH = 32K", RAM.start);
        let variables = format!(
            "RAM   : ORIGIN = {:#010x}, LENGTH = 96K",
            RAM.start + 0x8000
        );
        assert!(text.contains(&stack) && text.contains(&variables), "{text}");
        assert_eq!(RAM.end - RAM.start, (32 + 96) * 1024);
    }
}
