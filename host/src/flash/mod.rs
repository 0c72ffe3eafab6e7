//! The board's image, and programming the board through a debug probe.
//!
//! [`Image`] is what the ELF file asks for, checked without any hardware; [`program`] brings
//! it into the flash of a board behind a probe, and [`follow`] hands on what the board's log says through it. Over the
//! serial line an image goes by `host/src/update`.

mod image;
mod image_error;
#[cfg(feature = "flash")]
mod log;
mod map;
#[cfg(feature = "flash")]
mod program;
#[cfg(feature = "flash")]
mod rtt;
mod segments;
pub mod shipped;

pub use image::{Image, Program};
#[cfg(feature = "flash")]
pub use log::{Line, LogTable};
#[cfg(feature = "flash")]
pub use program::{FlashError, Progress, attach, choose_probe, probes, program};
#[cfg(feature = "flash")]
pub use rtt::{LogError, follow, restart, ring, runs};

/// The board's microcontroller, as probe-rs calls it.
pub const CHIP: &str = "STM32F405RGTx";

/// Where its flash begins, and the vector table with it.
pub const FLASH_ORIGIN: u64 = 0x0800_0000;
