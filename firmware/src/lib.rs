//! Firmware of the inm board: everything but the microcontroller.
//!
//! ```text
//!   acquire   the instrument: three converters to batches, health and events; commands to replies
//!   converters  settings and troubles of the protocol in terms of the driver (crate `ads1281`)
//!   platform  what the instrument needs of the machine it runs on
//!   mma7331l  from codes to volts and m/s^2
//!   proof     the bins that board and host compare
//!   log       what goes wrong, for a debug probe
//!   keep      what stays while the board is off: calibrations, in two sectors of flash
//!   update    programs in two slots of flash: which one starts, how a new one comes in
//!   ticks     a 32-bit timer made 64 bits wide
//!   emulated  a platform on the emulator's bench (feature `emulator`)
//! ```
//!
//! The same code runs in the STM32F405 image, in the image for QEMU, in the host's virtual
//! board and under test; they differ in their [`Platform`] only. `no_std`, no heap, no panic
//! on anything that a bus or a link can do.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod acquire;
pub mod converters;
#[cfg(feature = "emulator")]
pub mod emulated;
pub mod keep;
mod log;
pub mod mma7331l;
pub mod platform;
pub mod proof;
pub mod ticks;
pub mod update;

pub use acquire::Instrument;
pub use platform::{Board, Part, Platform};
