//! Talking to a board: a port that bytes come from, and commands with their replies.

mod client;
mod clock;
mod error;
mod intake;
mod port;
mod serial;
mod words;

pub(crate) use client::Expect;
pub use client::{Client, Patience};
pub use clock::{Arrival, Clock};
pub use error::LinkError;
pub use intake::open_to_record;
pub use port::{Connect, Port};
pub use serial::SerialConnect;
pub(crate) use words::{axis_name, describe, restarted};
