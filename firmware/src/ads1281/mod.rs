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
//! On the emulator's bench; on the board bus, pin and delay are the chip's.
//!
//! ```
//! use embedded_hal::delay::DelayNs;
//! use inm_emulator::{Bench, Constant, Converter};
//! use inm_firmware::ads1281::{Ads1281, POWER_UP_US};
//!
//! let bench = Bench::new([0, 1, 2].map(|axis| Converter::new(Constant(1000 * axis))));
//! let mut converter = Ads1281::new(bench.spi(2), bench.drdy(2), bench.delay());
//! bench.delay().delay_us(POWER_UP_US);
//! converter.reset()?;
//! converter.read_continuously()?;
//! converter.forget_edge();
//! bench.run_until_edge(2, u64::MAX).expect("a conversion within 64 ms");
//! let reading = converter.read()?;
//! assert_eq!(reading.word.value(), 2000);
//! assert!(!reading.torn);
//! # Ok::<(), inm_firmware::ads1281::Error>(())
//! ```

pub mod calibrate;
pub mod command;
pub mod config;
mod driver;
mod error;
pub mod register;
pub mod slip;
pub mod slip_mean;
pub mod word;

use embedded_hal::digital::InputPin;

pub use driver::{Ads1281, Mode};
pub use error::Error;

/// Clock of the converter, hertz: the highest it allows, on which its data rates are stated.
pub const CLOCK_HZ: u32 = 4_096_000;

/// Pause after each byte of a command, nanoseconds: 24 clocks (SBAS378D, page 30), rounded up.
pub const GAP_NS: u32 = 5_860;

/// The converter puts the next word into its output register this long before DRDY falls,
/// nanoseconds: 4 clocks (SBAS378D, page 24), rounded up.
pub const UPDATE_LEAD_NS: u32 = 980;

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

/// DRDY, active low: the level, and a falling edge remembered.
pub trait DataReady: InputPin {
    /// Whether the pin has fallen since the last call.
    ///
    /// The edge is latched by hardware (as in the pending register of an EXTI) or by an
    /// interrupt handler, so that an edge is seen whatever the program did meanwhile, and two
    /// count as one.
    fn take_edge(&mut self) -> bool;
}
