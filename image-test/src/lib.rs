//! The board's flash image, unmodified, on a register-level model of its chip.
//!
//! ```text
//!   image     the ELF that `cargo xtask firmware` builds, byte for byte
//!   machine   the core: instructions (Unicorn), time, sleep, exceptions, resets
//!   chip      one file a peripheral of the STM32F405, as its reference manual (RM0090) has it
//!   board     what is soldered to the chip: crystal, converters (crate inm-emulator), host
//!   record    the accelerometers' signal, and the words that must come of it
//! ```
//!
//! README.md says what is assumed and what is not claimed.
//!
//! Sections of RM0090 are those of revision 19, of PM0214 (the core) those of revision 10.

pub mod board;
pub mod chip;
pub mod image;
pub mod machine;
pub mod record;
