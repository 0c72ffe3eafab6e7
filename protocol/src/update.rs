//! The frozen messages of the loader: what brings a new program onto a board over its serial line.
//!
//! ```text
//!   payload = F0 | message (postcard) | CRC-32           in the frames of everything else
//! ```
//!
//! They stand in frames of a protocol version of their own, [`LOADER`], so that a host of any version
//! updates a board of any version. No byte of them ever changes its meaning; a later loader may know more
//! variants, at the end of a list. A loader says [hello](crate::Hello) with this version, so that an older
//! host, which knows nothing of it, can name the board all the same.

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use crate::frame::Message;

/// Version byte of the loader's frames. The versions of the measuring program count up from 1 and stay
/// below it.
pub const LOADER: u8 = 0xF0;

/// Most bytes in one [`ToLoader::Data`]: the longest power of two whose frame is no longer than that of a
/// batch.
pub const CHUNK: usize = 512;

/// Longest name of a board, in bytes, as in the identity.
const TEXT: usize = 16;

/// Payload of a frame that asks for the loader: the version, the number of [`ToLoader::Enter`], and a zero
/// that the decoder sets behind a message.
pub(crate) const ENTER: [u8; 3] = [LOADER, 0, 0];

/// Host to loader. Every message is answered by one [`FromLoader`]; a host that gets none sends the same
/// once more, which does no harm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
// Data are the common case by far and there is no heap to box them into.
#[allow(clippy::large_enum_variant)]
pub enum ToLoader {
    /// To the program that measures: end the stream and restart into the loader. The loader answers it as
    /// [`Self::Status`]; the program, with nothing.
    Enter,
    /// How far it is. Answered behind a hello.
    Status,
    /// A program will follow. Erases the slot that it goes to, which takes up to 4 s a sector of 128 KB; the
    /// same message again while its data are under way erases nothing, and the answer says where to go on.
    Begin(NewProgram),
    /// Bytes of the program.
    Data {
        /// Their place from the start of the program; a multiple of four.
        offset: u32,
        /// The bytes; a multiple of four.
        bytes: Vec<u8, CHUNK>,
    },
    /// Verify the program, and start it from now on in place of the other.
    Commit,
    /// Restart, and start a program.
    Start,
}

/// A program that the host has.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NewProgram {
    /// Address that it is linked for: that of its vector table, [`LoaderStatus::address`].
    pub address: u32,
    /// Bytes; a multiple of four.
    pub length: u32,
    /// CRC-32 of the frames, over all of them.
    pub crc: u32,
    /// Board that it is for, as its mark says: `stm32f405`.
    pub platform: String<TEXT>,
}

/// Loader to host.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum FromLoader {
    /// It was done; so far it is.
    Status(LoaderStatus),
    /// It was not done.
    Refused(LoaderRefusal),
}

/// How far a loader is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct LoaderStatus {
    /// Slot, 0 or 1, whose program a restart starts; `None` where there is none to start.
    pub starts: Option<u8>,
    /// Slot that the next program goes to.
    pub free: u8,
    /// Address that the next program has to be linked for.
    pub address: u32,
    /// Bytes that it may have.
    pub room: u32,
    /// Bytes of the program under way that are written; 0 where none is.
    pub written: u32,
}

/// Why a loader did not do what it was asked. The program that it starts is untouched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LoaderRefusal {
    /// The program is for another board.
    WrongBoard,
    /// The program is linked for another place.
    WrongAddress {
        /// Where it has to be linked for.
        expected: u32,
    },
    /// It is empty, not a multiple of four bytes, or longer than the slot.
    WrongLength {
        /// Most bytes.
        room: u32,
    },
    /// No program is under way: it was never begun, or was given up.
    NotBegun,
    /// These data do not follow those before them, or do not belong to the program at all; or some are
    /// missing.
    WrongPlace {
        /// Offset of the data that come next.
        expected: u32,
    },
    /// What was written is not what was announced: it was given up.
    WrongCrc {
        /// CRC-32 of what was written.
        found: u32,
    },
    /// Its vector table starts no program: it was given up.
    NoProgram,
    /// The flash could not be erased or written: it was given up.
    NotWritten,
    /// There is no program to start.
    NothingToStart,
}

impl Message for ToLoader {
    const VERSION: u8 = LOADER;
}

impl Message for FromLoader {
    const VERSION: u8 = LOADER;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Decoder, Fault, MAX_FRAME, ToBoard, VERSION, encode};

    #[test]
    fn a_program_knows_who_asks_for_the_loader_and_nothing_else_of_it() {
        let mut decoder: Decoder<128> = Decoder::with_capacity();
        let mut frame = [0; MAX_FRAME];
        for message in [ToLoader::Status, ToLoader::Enter, ToLoader::Commit] {
            let len = encode(&message, &mut frame).expect("it has room");
            let met = decoder.next::<ToBoard>(&mut &frame[..len]);
            assert_eq!(met, Some(Err(Fault::Version { theirs: LOADER })));
            assert_eq!(decoder.asks_for_loader(), message == ToLoader::Enter);
        }
        const { assert!(VERSION < LOADER) };
    }

    #[test]
    fn the_longest_message_has_room_in_a_frame() {
        let data = ToLoader::Data {
            offset: u32::MAX,
            bytes: [0xff; CHUNK].into_iter().collect(),
        };
        let mut frame = [0; MAX_FRAME];
        let len = encode(&data, &mut frame).expect("it has room");
        let mut decoder = Decoder::new();
        assert_eq!(decoder.next(&mut &frame[..len]), Some(Ok(data)));
    }
}
