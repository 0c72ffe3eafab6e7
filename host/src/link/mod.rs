//! Talking to a board: a port that bytes come from, and commands with their replies.

mod client;
mod error;
mod port;

pub use client::{Client, Patience};
pub use error::LinkError;
pub use port::{Connect, Port, SerialConnect};
