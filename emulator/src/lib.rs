//! A register-level ADS1281 on an emulated SPI bus, in virtual time.
//!
//! What a driver sees here is what it would see at the part's pins: bits on DOUT, the DRDY level
//! and its edges, and nothing else. The part's rules are *enforced*: a driver that leaves out a
//! gap, reads a register without SDATAC or writes a reserved register is told so ([`Rule`]), at
//! the byte that did it. The words come from a real digital filter ([`filter`]) fed by any
//! [`Signal`], usually the MMA7331L [`channel`].
//!
//! ```text
//! Signal ── 32 inputs a conversion ──> modulator ──> sinc5, FIR1..4, [HPF] ──> OFC, FSC, clip ──> word
//!                                      (over-range)   filter                   word                │
//!     driver <── Spi, Drdy, SyncPin, Delay (embedded-hal) <── Bench (time) <── Converter (registers, bus)
//! ```
//!
//! Everything runs without `std`, without a heap and, once constructed, in integers: the same
//! code on a Cortex-M4 and on a PC makes the same words from the same seeds. [`response`] is the
//! exception: the filter's frequency response in `f64`, for those who analyse the words.
//!
//! Facts come from the ADS1281 data sheet (Texas Instruments SBAS378D) with the page named, or
//! from a sibling's sheet (ADS1282, 1283, 1285, 1287: one family, one filter) where SBAS378D was
//! not at hand. This register map is written down independently of any driver, so that one cannot
//! excuse the other.
//!
//! ```
//! use embedded_hal::{delay::DelayNs, spi::SpiBus};
//! use inm_emulator::{Bench, Constant, Converter};
//!
//! let bench = Bench::new([0, 1, 2].map(|axis| Converter::new(Constant(1000 * axis))));
//! bench.delay().delay_ms(20); // power-on: 2^16 clocks
//! bench.spi(2).write(&[0x11])?; // SDATAC
//! bench.delay().delay_us(6);
//! bench.spi(2).write(&[0x10])?; // RDATAC
//! bench.delay().delay_us(6);
//! bench.run_until_edge(2, u64::MAX).expect("a conversion within 64 ms");
//! let mut word = [0; 4];
//! bench.spi(2).transfer_in_place(&mut word)?;
//! assert_eq!(i32::from_be_bytes(word) >> 1, 2000);
//! assert_eq!(bench.violation(), None);
//! # Ok::<(), inm_emulator::BusError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

mod alignment;
mod bench;
pub mod channel;
mod command;
mod conversion;
mod converter;
mod drdy;
mod fault;
pub mod filter;
mod fir;
mod flicker;
mod high_pass;
pub mod link;
mod modulator;
mod pins;
mod plan;
mod random;
mod registers;
pub mod response;
mod rule;
pub mod sensor;
mod sent;
mod serial;
mod signal;
mod spi;
pub mod tables;
pub mod time;
pub mod word;

pub use bench::Bench;
pub use conversion::Conversion;
pub use converter::{Converter, ReadMode};
pub use fault::Fault;
pub use pins::{Delay, Drdy, SyncPin};
pub use registers::{Output, Registers};
pub use rule::{Rule, Violation};
pub use sent::Sent;
pub use serial::{Slip, Tear};
pub use signal::{Constant, Ramp, Recorded, Signal, Sine};
pub use spi::{BusError, Spi};
pub use tables::Phase;
