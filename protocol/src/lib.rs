//! The contract between the board and its host.
//!
//! Both ends link this crate and nothing else in common. A message is a [postcard] value
//! preceded by the protocol [`VERSION`] and followed by a CRC-32; the whole is COBS-encoded
//! and ends in a zero byte, so that a receiver that has lost its place finds the next frame
//! at the next zero. `WIRE.md` beside this crate writes the format down byte by byte, and
//! `tests/golden.rs` holds it to that.
//!
//! ```text
//!   ToHost / ToBoard --encode--> frame bytes --(UART, file, pty)--> Decoder --> ToHost / ToBoard
//! ```
//!
//! The crate is `no_std`, has no heap and no panic path: the [`Decoder`] accepts any bytes in
//! any split.
//!
//! [postcard]: https://postcard.jamesmunns.com
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod budget;
mod calibration;
mod command;
mod decoder;
mod frame;
mod health;
mod hello;
pub mod image;
mod message;
mod pulse;
mod sample;
mod settings;
pub mod slot;
pub mod update;

pub use budget::{Load, link_bytes_per_s, samples_load};
pub use calibration::{SensorCalibration, TRIANGLE};
pub use command::{Answer, Command, Identity, Refusal, Reply, Request, Restart, SelfTestStep};
pub use decoder::{Counts, Decoder, Fault};
pub use frame::{EncodeError, FRAME_END, MAX_FRAME, MAX_PAYLOAD, Message, crc32, encode};
pub use health::{AxisCounters, BinsMark, Health, LinkCounters};
pub use hello::{HELLO, Hello};
pub use message::{Event, MAX_MARK, Note, ToBoard, ToHost, Trouble, UNPROVEN_PERIODS};
pub use pulse::{Pulse, PulseCounters};
pub use sample::{Batch, Code, Flag, Flags};
pub use settings::{Filter, Phase, Rate, SensorRange, Settings};

/// Version of the wire format, the first byte of every frame.
///
/// It changes whenever any byte of any message changes its meaning; postcard is not
/// self-describing, so two versions cannot be told apart by their content. Frames of version 1, which
/// did not say of which stream they are, are still read: captures hold them.
pub const VERSION: u8 = 2;

/// The version whose messages lack nothing but [`Batch::stream`], [`Health::stream`] and
/// [`Event::stream`].
const WITHOUT_STREAM: u8 = 1;

/// Converters on the board: X, Y, Z.
pub const AXES: usize = 3;

/// Registers of one ADS1281, 00h to 0Ah.
pub const REGISTERS: usize = 11;

/// Most conversions in one [`Batch`].
///
/// 32 conversions make the frame overhead 8 % and the latency 8 ms at 4000/s, 128 ms at 250/s.
pub const BATCH_LEN: usize = 32;
