//! Why a file is not an image for the board.

use std::io;
use std::ops::Range;
use std::path::PathBuf;

use super::{FLASH_ORIGIN, map};

/// Why a file is not an image for the board.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct ImageError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: Problem,
}

/// What is wrong with an image, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be read.
    #[error("the file cannot be read: {0}")]
    Io(io::Error),
    /// Not a 32-bit ELF file, or damaged.
    #[error("not a 32-bit ELF file: {0}; build one with `cargo xtask firmware`")]
    NotElf(object::Error),
    /// A segment lies beyond the end of the file.
    #[error("the file ends at byte {len}, inside a segment; build or copy it again")]
    Cut {
        /// Its length.
        len: usize,
    },
    /// For another processor.
    #[error(
        "built for ELF machine {machine}, the board is Arm (40); build one with `cargo xtask firmware`"
    )]
    NotArm {
        /// Its `e_machine`.
        machine: u16,
    },
    /// Nothing at the origin of the flash, where the processor looks for its vector table.
    #[error(
        "no vector table at {FLASH_ORIGIN:#010x}: the linker script was lost (is RUSTFLAGS set?); \
         build it with `cargo xtask firmware`"
    )]
    NoVectorTable,
    /// A segment lies elsewhere than the loader and the programs, or reaches beyond one of them.
    #[error(
        "{} bytes at {:#010x} lie where neither the loader nor a program does, or reach there ({:#010x}): {}; \
         an image of the board has nothing there, build it with `cargo xtask firmware`",
        at.end - at.start, at.start, outside, map::place(*outside)
    )]
    Outside {
        /// Addresses of the segment.
        at: Range<u64>,
        /// The first of them outside.
        outside: u64,
    },
    /// A slot is empty, or what lies there has no header.
    #[error(
        "no program for slot {slot}, at {start:#010x}: the image is not whole, or of a release before the \
         loader; build it with `cargo xtask firmware`"
    )]
    NoProgram {
        /// Which one.
        slot: usize,
        /// Where it begins.
        start: u64,
    },
    /// Two programs in one file that are not the same.
    #[error(
        "its programs differ: firmware {first} and firmware {second}; build it with `cargo xtask firmware`"
    )]
    Mixed {
        /// That of the first slot.
        first: String,
        /// That of the second.
        second: String,
    },
    /// Two segments want the same flash.
    #[error(
        "two segments overlap at {at:#010x}; the file is damaged, build it with `cargo xtask firmware`"
    )]
    Overlap {
        /// The first address that is there twice.
        at: u64,
    },
    /// The processor would not come further than its first instruction.
    #[error(
        "the vector table does not start a program: {what} is {value:#010x}; expected {expected}; \
         build it with `cargo xtask firmware`"
    )]
    Vector {
        /// Which of its words.
        what: &'static str,
        /// That word.
        value: u32,
        /// What it may be.
        expected: &'static str,
    },
    /// Not one of ours, or not finished.
    #[error("the image does not say what it is: {0}; build it with `cargo xtask firmware`")]
    NoMark(&'static str),
    /// For another machine.
    #[error(
        "the image is for `{platform}`, not for the board (`{}`); build it with `cargo xtask firmware`",
        inm_protocol::image::BOARD
    )]
    Platform {
        /// What it says.
        platform: String,
    },
    /// The bytes are not those that were built.
    #[error(
        "the image's checksum is {found:#010x}, it says {said:#010x}: the file is damaged; copy or build it again"
    )]
    Checksum {
        /// Of its bytes.
        found: u32,
        /// In its mark.
        said: u32,
    },
}
