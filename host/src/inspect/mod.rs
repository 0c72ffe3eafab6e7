//! What a board on a port says when it is asked by hand: who it is, in which state, what it measures
//! of itself, what has gone wrong. Nothing is recorded.
//!
//! ```text
//!   Session (command, reply, and what the board says unasked)
//!      |
//!      +--> info, self_test, reset, log      each a question and its answer as plain data
//!      +--> gravity                          what the sensors read at rest, for a calibration
//!   ports: what this machine has, without a byte sent
//! ```

pub mod gravity;
pub mod info;
pub mod log;
pub mod ports;
pub mod reset;
pub mod self_test;
mod session;

pub use session::{Heard, Session};

use inm_protocol::{AXES, Identity};

/// Names of the axes, in the order of the codes.
pub const AXIS_NAMES: [&str; AXES] = ["X", "Y", "Z"];

/// The board's serial number as it is written: 24 hexadecimal digits.
pub fn serial(identity: &Identity) -> String {
    identity.serial.map(|word| format!("{word:08x}")).concat()
}
