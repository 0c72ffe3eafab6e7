//! Driver of the ADS1281, a 31-bit delta-sigma converter (Texas Instruments, SBAS378D).
//!
//! ```text
//!   command   opcodes        register   addresses and fields     config  settings to registers
//!   word      one reading    calibrate  OFC and FSC
//!   slip      the level jumped by two, word by word or (slip_mean) under much noise
//! ```
//!
//! The part has no CS: every clock counts, nothing realigns a shifted stream but its RESET pin
//! or 64 data periods without a clock, and a command in the wrong mode is lost without a word.
//! The driver therefore owns its bus, knows the mode, keeps the gap of 24 clocks after every
//! byte of a command, leaves read-continuous mode before it touches a register, and reads back
//! what it wrote.
//!
//! Nothing here allocates, blocks for longer than a command's gaps, or panics on anything that the bus
//! can do. DRDY is a [`DataReady`]: a pin with a latch for its edge, or a [`Polled`] one.
//!
//! ```
//! use ads1281::{Ads1281, DataReady, Error};
//! use embedded_hal::delay::DelayNs;
//! use embedded_hal::spi::SpiBus;
//!
//! /// The next value behind the filter, in steps of VREF / (2 (2^30 - 1)).
//! fn next<S: SpiBus, D: DataReady, W: DelayNs>(
//!     converter: &mut Ads1281<S, D, W>,
//! ) -> Result<i32, Error<S::Error>> {
//!     converter.read_continuously()?;
//!     loop {
//!         if let Some(reading) = converter.take_new()? {
//!             return Ok(reading.word.value());
//!         }
//!     }
//! }
//! ```
//!
//! With the feature `defmt` its types can be logged by defmt.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod calibrate;
pub mod command;
pub mod config;
mod driver;
mod error;
mod pins;
pub mod register;
pub mod slip;
pub mod slip_mean;
pub mod word;

pub use driver::{Ads1281, Mode};
pub use error::Error;
pub use pins::{DataReady, NoReset, Polled, ResetPin, Wired};

/// Clock of the converter, hertz: the highest it allows, on which its data rates are stated.
pub const CLOCK_HZ: u32 = 4_096_000;

/// Pause after each byte of a command, nanoseconds: 24 clocks (SBAS378D, page 30), rounded up.
pub const GAP_NS: u32 = 5_860;

/// The converter puts the next word into its output register this long before DRDY falls,
/// nanoseconds: 4 clocks (SBAS378D, page 24), rounded up.
pub const UPDATE_LEAD_NS: u32 = 980;

/// How long the RESET pin is held low, microseconds. Two clocks, half a microsecond, are asked for; a delay counts whole microseconds and a slow edge takes its share.
pub const RESET_PULSE_US: u32 = 2;

/// Pause after RESET before the next command, microseconds. Two clocks are asked for; this
/// leaves the part time to load its registers.
pub const RESET_US: u32 = 1_000;

/// From power on until the part listens, microseconds: 2^16 clocks, rounded up.
pub const POWER_UP_US: u32 = 20_000;

/// Readings interrupted by SYNC, by RESET and by every register write (SBAS378D, page 21).
pub const SETTLING_READINGS: u32 = 63;

/// Data periods without a clock after which the serial interface starts a new byte: 64, and
/// two for the phase.
pub const IDLE_READINGS: u32 = 66;

/// The example of the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
