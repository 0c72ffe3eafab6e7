//! The recording: a text header and then every byte as it came from the board.
//!
//! ```text
//! #inm-capture 1\n
//! {"protocol":2,"created":"...","board":{...},"settings":{...},"axes":[...]}\n
//! frame frame frame ...            as in protocol/WIRE.md, damaged ones included
//! ```
//!
//! The file is only ever appended to, and each read from the port is written at once, so a
//! capture cut at any byte is a capture of everything up to its last whole frame. Header and name are
//! on the disk before the first frame, and frames a second after they were written ([`SYNC_PERIOD`]), so
//! that a loss of power costs no more. What the
//! host itself has to say (the port went away, the recording was ended on purpose) stands
//! between the frames as a [`Note`](inm_protocol::Note) in a frame of its own. Because the
//! bytes are kept as received, `inm replay` sends them down the path that live data take, and
//! a fault of the link can be looked at years later.

mod check;
mod durable;
mod error;
mod header;
mod reader;
mod writer;

pub use durable::Durable;
pub use error::CaptureError;
pub(crate) use header::corrects;
pub use header::{BoardHeader, ClockSource, Header, RegistersOf};
pub use reader::Reader;
pub use writer::{SYNC_PERIOD, Writer, note_frame};

/// First line of every capture, without its line feed.
pub const MAGIC: &str = "#inm-capture 1";

#[cfg(test)]
mod tests;
