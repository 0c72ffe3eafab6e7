//! What can go wrong between host and board.

use std::io;
use std::time::Duration;

use inm_protocol::update::LOADER;
use inm_protocol::{Hello, Refusal, Request, VERSION};

use super::words::{board_of, release_of, why};

/// Why the board cannot be reached, or does not do what it was asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// The port cannot be opened.
    #[error("{port}: the port cannot be opened: {source}")]
    Open {
        /// Name of the port.
        port: String,
        /// Ports that this machine has.
        available: Vec<String>,
        /// What the system said.
        #[source]
        source: serialport::Error,
    },
    /// Reading or writing failed: the port went away.
    #[error("{port}: the port went away")]
    Gone {
        /// Name of the port.
        port: String,
        /// What the system said.
        #[source]
        source: io::Error,
    },
    /// Nothing intact came through a port that is open.
    #[error("{port}: the board fell silent: nothing for {} s, and no answer since", since.as_secs())]
    Silent {
        /// Name of the port.
        port: String,
        /// How long nothing had been heard when it was noticed.
        since: Duration,
    },
    /// The board ended the stream by itself, and does not start it again.
    #[error("{port}: the board stopped streaming, and no answer since")]
    Stopped {
        /// Name of the port.
        port: String,
    },
    /// Another board than the one that was recorded.
    #[error("{port}: another board is there: {what}")]
    OtherBoard {
        /// Name of the port.
        port: String,
        /// What differs, in words.
        what: String,
    },
    /// No reply.
    #[error("{port}: no answer to `{request:?}` within {} ms, asked {tries} times", waited.as_millis())]
    NoReply {
        /// Name of the port.
        port: String,
        /// What was asked.
        request: Box<Request>,
        /// How long each time.
        waited: Duration,
        /// How often.
        tries: u32,
    },
    /// The board speaks another version.
    #[error("{port}: the board{} speaks protocol version {theirs}, this program version {VERSION}", board_of(board.as_deref()))]
    Version {
        /// Name of the port.
        port: String,
        /// The board's version.
        theirs: u8,
        /// What it says of itself; `None` of firmware from before it did so to hosts of any version.
        board: Option<Box<Hello>>,
    },
    /// No program runs there: the board's loader listens.
    #[error("{port}: the board{} runs no program: its loader listens", board_of(board.as_deref()))]
    Loader {
        /// Name of the port.
        port: String,
        /// What it says of itself; the release is the loader's.
        board: Option<Box<Hello>>,
    },
    /// The board said no.
    #[error("{port}: the board refuses `{request:?}`: {}", why(*refusal))]
    Refused {
        /// Name of the port.
        port: String,
        /// What was asked.
        request: Box<Request>,
        /// Its reason.
        refusal: Refusal,
    },
    /// The reply does not belong to the request.
    #[error("{port}: the answer to `{request:?}` is of another kind")]
    WrongAnswer {
        /// Name of the port.
        port: String,
        /// What was asked.
        request: Box<Request>,
    },
}

impl LinkError {
    /// The error for frames of a version that is not ours.
    pub(super) fn of_version(port: String, theirs: u8, board: Option<Hello>) -> Self {
        let board = board.map(Box::new);
        match theirs {
            LOADER => Self::Loader { port, board },
            theirs => Self::Version {
                port,
                theirs,
                board,
            },
        }
    }

    /// What to do about it.
    pub fn remedy(&self) -> String {
        match self {
            Self::Open { available, .. } if available.is_empty() => {
                "this machine has no serial port: plug the board in, or use `--source virtual`"
                    .to_owned()
            }
            Self::Open { available, .. } => {
                format!("ports of this machine: {}", available.join(", "))
            }
            Self::Gone { .. } => "check cable and power of the board".to_owned(),
            Self::Silent { .. } | Self::Stopped { .. } => {
                "what was recorded is kept; check power and supply of the board, or wait longer for \
                 it (--reconnect)"
                    .to_owned()
            }
            Self::OtherBoard { .. } => {
                "plug the board of this recording in again, or begin a new recording; what was \
                 recorded is kept"
                    .to_owned()
            }
            Self::NoReply { .. } => {
                "is this the board's port, is the board powered, is its firmware flashed \
                 (`inm flash`)?"
                    .to_owned()
            }
            Self::Version { board, .. } => format!(
                "bring the firmware of this release onto it (`inm board update`, with a probe `inm flash`), or use the \
                 program {}",
                release_of(board.as_deref())
            ),
            Self::Loader { .. } => "bring a program onto it (`inm board update`); where it has one, it starts it \
                                    after a minute of silence"
                .to_owned(),
            Self::Refused { refusal, .. } => match refusal {
                Refusal::Streaming => "stop the stream first".to_owned(),
                Refusal::LinkTooSlow { .. } | Refusal::BusTooSlow { .. } => {
                    "choose a lower rate, or the FIR filter".to_owned()
                }
                Refusal::Converter { .. } => {
                    "check supply, clock and SPI wiring of that converter".to_owned()
                }
                Refusal::Unsound => "calibrate again (`inm calibrate`)".to_owned(),
                Refusal::NotKept => {
                    "try again; if it stays so, the flash of its microcontroller is worn or write-protected"
                        .to_owned()
                }
            },
            Self::WrongAnswer { .. } => "restart the board and try again".to_owned(),
        }
    }
}
