//! The board's image, and programming the board through a debug probe.
//!
//! [`Image`] is what the ELF file asks for, checked without any hardware; [`program`] brings
//! it into the flash of a board behind a probe. Over the serial line it goes by `host/src/update`.

mod image;
mod image_error;
mod map;
#[cfg(feature = "flash")]
mod program;
mod segments;

pub use image::{Image, Program};
#[cfg(feature = "flash")]
pub use program::{FlashError, Progress, choose_probe, program};

/// The board's microcontroller, as probe-rs calls it.
pub const CHIP: &str = "STM32F405RGTx";

/// Where its flash begins, and the vector table with it.
pub const FLASH_ORIGIN: u64 = 0x0800_0000;
