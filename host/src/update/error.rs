//! Why a board has no new program.

use inm_protocol::update::LoaderRefusal;

use crate::link::LinkError;

/// Why a board has no new program, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UpdateError {
    /// The port cannot be opened, or went away.
    #[error("{}; the board keeps the program that it has: {}, and try again", .0, .0.remedy())]
    Link(LinkError),
    /// Nothing answers.
    #[error(
        "{port}: no answer; is this the board's port, is the board powered? It keeps the program that it has: \
         try again"
    )]
    Nobody {
        /// Name of the port.
        port: String,
    },
    /// A board that the image is not for.
    #[error(
        "{port}: the board there is for `{platform}`, and the image is for `stm32f405`; name another port"
    )]
    OtherBoard {
        /// Name of the port.
        port: String,
        /// What it says of itself.
        platform: String,
    },
    /// A program that does not know the loader, or a board without one.
    #[error(
        "{port}: the board (firmware {firmware}) does not go into its loader: its firmware is from before it \
         or the loader is not there; program it once through a debug probe (`inm flash`)"
    )]
    NoLoader {
        /// Name of the port.
        port: String,
        /// Release of its firmware.
        firmware: String,
    },
    /// The board wants a program linked for a place that the image has none for.
    #[error(
        "{port}: the board's loader wants a program for {address:#010x}, and the image has none; build it with \
         `cargo xtask firmware` of the release of the loader"
    )]
    NoSlot {
        /// Name of the port.
        port: String,
        /// Where it has to be linked for.
        address: u32,
    },
    /// The loader said no.
    #[error("{port}: the board's loader refuses: {}; the board keeps the program that it has", why(*refusal))]
    Refused {
        /// Name of the port.
        port: String,
        /// Its reason.
        refusal: LoaderRefusal,
    },
    /// The board restarted in the middle.
    #[error(
        "{port}: the board restarted in the middle, into the program that it had; check its supply and try again"
    )]
    BrokenOff {
        /// Name of the port.
        port: String,
    },
    /// The new program is there, and another one answers.
    #[error(
        "{port}: firmware {wanted} was written and verified, and {found} answers: the new program did not start; \
         the board has gone back to the one before"
    )]
    Other {
        /// Name of the port.
        port: String,
        /// Release that answers.
        found: String,
        /// Release that was written.
        wanted: String,
    },
    /// The new program is there, and the one before, of the same release, runs.
    #[error(
        "{port}: firmware {wanted} was written and verified, and the program before it, of the same release, answers: the \
         new program did not start; the board has gone back to the one before"
    )]
    FellBack {
        /// Name of the port.
        port: String,
        /// Release of both.
        wanted: String,
    },
    /// The new program is there, and does not answer.
    #[error(
        "{port}: the new program was written and verified, and does not answer; switch the board off and on up to \
         four times: it goes back to the program before then"
    )]
    NotBack {
        /// Name of the port.
        port: String,
    },
}

/// A refusal in words, with what to do.
fn why(refusal: LoaderRefusal) -> String {
    match refusal {
        LoaderRefusal::WrongBoard => {
            "the program is for another board; take the image of this one".to_owned()
        }
        LoaderRefusal::WrongAddress { expected } => format!(
            "the program is not linked for {expected:#010x}; has something else been written meanwhile? Try again"
        ),
        LoaderRefusal::WrongLength { room } => {
            format!("the program has no length of up to {room} bytes; build it again")
        }
        LoaderRefusal::NotBegun => "it has given the program up; try again".to_owned(),
        LoaderRefusal::WrongPlace { expected } => {
            format!("byte {expected} was to come next; try again")
        }
        LoaderRefusal::WrongCrc { found } => format!(
            "what it has written has the checksum {found:#010x}, which was not announced; try again, and if it \
             stays so, its flash is worn"
        ),
        LoaderRefusal::NoProgram => {
            "the vector table starts no program; build the image again".to_owned()
        }
        LoaderRefusal::NotWritten => {
            "its flash could not be erased or written; try again, and if it stays so, it is worn or \
             write-protected"
                .to_owned()
        }
        LoaderRefusal::NothingToStart => "it has no program to start".to_owned(),
    }
}
