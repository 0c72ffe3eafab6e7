//! From bytes in any split, with any damage, back to messages.

use serde::de::DeserializeOwned;

use crate::frame::{CRC, CRC_LEN, FRAME_END, MAX_FRAME};
use crate::update::ENTER;
use crate::{Hello, Message, VERSION, WITHOUT_STREAM};

/// What was wrong with the bytes between two zeros.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[non_exhaustive]
pub enum Fault {
    /// More bytes than any frame has; a zero was lost, or this is not our stream.
    TooLong,
    /// Not a COBS frame, or too short to hold anything.
    Framing,
    /// The check sum does not match: bits were changed, or bytes lost.
    Crc,
    /// An intact frame of another protocol version.
    Version {
        /// Version of the sender.
        theirs: u8,
    },
    /// An intact frame of our version whose message is not known here.
    Message,
}

impl core::fmt::Display for Fault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooLong => f.write_str("frame longer than any message"),
            Self::Framing => f.write_str("not a frame"),
            Self::Crc => f.write_str("check sum does not match"),
            Self::Version { theirs } => {
                write!(
                    f,
                    "protocol version {theirs}, this program speaks {VERSION}"
                )
            }
            Self::Message => f.write_str("unknown message"),
        }
    }
}

impl core::error::Error for Fault {}

/// What a [`Decoder`] has seen so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Messages delivered.
    pub frames: u64,
    /// Frames thrown away.
    pub faults: u64,
    /// Bytes of the frames thrown away, their zeros included.
    pub bytes_lost: u64,
}

/// A pure push parser: bytes in, messages out, no I/O, no panic.
///
/// Whatever comes in, the decoder holds at most one frame and finds its place again at the
/// next zero byte. `N` is the longest frame it accepts.
#[derive(Debug, Clone)]
pub struct Decoder<const N: usize = MAX_FRAME> {
    frame: [u8; N],
    /// Bytes since the last zero; beyond `N` they are only counted.
    len: usize,
    counts: Counts,
    /// Version of the last frame whose check sum matched.
    version: Option<u8>,
    hello: Option<Hello>,
    /// The last frame asks for the loader.
    enter: bool,
}

impl Decoder {
    /// A decoder for frames up to [`MAX_FRAME`].
    pub const fn new() -> Self {
        Self::with_capacity()
    }
}

impl<const N: usize> Default for Decoder<N> {
    fn default() -> Self {
        Self::with_capacity()
    }
}

impl<const N: usize> Decoder<N> {
    /// A decoder for frames of at most `N` bytes.
    pub const fn with_capacity() -> Self {
        Self {
            frame: [0; N],
            len: 0,
            counts: Counts {
                frames: 0,
                faults: 0,
                bytes_lost: 0,
            },
            version: None,
            hello: None,
            enter: false,
        }
    }

    /// Takes bytes from the front of `input` until one frame is complete.
    ///
    /// Returns its message, or its fault, or `None` when `input` is used up in the middle of
    /// a frame. Call it again for the rest:
    ///
    /// ```
    /// # use inm_protocol::{Decoder, ToHost};
    /// # fn read_port() -> [u8; 3] { [1, 2, 0] }
    /// let mut decoder = Decoder::new();
    /// let bytes = read_port();
    /// let mut input = &bytes[..];
    /// while let Some(result) = decoder.next::<ToHost>(&mut input) {
    ///     match result {
    ///         Ok(message) => println!("{message:?}"),
    ///         Err(fault) => eprintln!("{fault}"),
    ///     }
    /// }
    /// ```
    ///
    /// Zeros in a row are not a fault: a sender may put one ahead of a frame to end whatever
    /// the receiver believes to be in.
    pub fn next<M: Message + DeserializeOwned>(
        &mut self,
        input: &mut &[u8],
    ) -> Option<Result<M, Fault>> {
        loop {
            let end = input.iter().position(|&byte| byte == FRAME_END);
            let taken = &input[..end.unwrap_or(input.len())];
            if let Some(room) = self.frame.get_mut(self.len..self.len + taken.len()) {
                room.copy_from_slice(taken);
            }
            self.len = self.len.saturating_add(taken.len());
            let Some(end) = end else {
                *input = &[];
                return None;
            };
            *input = &input[end + 1..];
            let len = core::mem::take(&mut self.len);
            if len > 0
                && let Some(result) = self.finish(len)
            {
                return Some(result);
            }
        }
    }

    /// What has been seen so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Protocol version of the last intact frame.
    pub fn version(&self) -> Option<u8> {
        self.version
    }

    /// The last hello of a board, of whatever version; none is a message or a fault.
    pub fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// Whether the last frame asks a board for its [loader](crate::update::ToLoader::Enter), whatever the
    /// version of both. [`Self::next`] calls it a frame of another version.
    pub fn asks_for_loader(&self) -> bool {
        self.enter
    }

    /// Bytes of the frame that has begun and not ended.
    pub fn pending(&self) -> usize {
        self.len
    }

    /// The message of a frame, or its fault; `None` of a hello, which is kept.
    fn finish<M: Message + DeserializeOwned>(&mut self, len: usize) -> Option<Result<M, Fault>> {
        self.enter = false;
        let frame = self.frame.get_mut(..len).ok_or(Fault::TooLong);
        let result = match frame.and_then(check) {
            Ok(payload) => {
                self.version = payload.first().copied();
                self.enter = payload == ENTER;
                if let Some(hello) = hello(payload) {
                    self.hello = Some(hello);
                    return None;
                }
                message(payload)
            }
            Err(fault) => Err(fault),
        };
        match result {
            Ok(_) => self.counts.frames += 1,
            Err(_) => {
                self.counts.faults += 1;
                self.counts.bytes_lost += len as u64 + 1;
            }
        }
        Some(result)
    }
}

/// The hello of a checked frame, if it is one.
fn hello(payload: &[u8]) -> Option<Hello> {
    let (version, message) = payload.split_first()?;
    // The zero behind a message is none of its bytes.
    let (_, message) = message.split_last()?;
    Hello::of(*version, message)
}

/// Decodes one frame (without its closing zero) in place, and checks its sum: what stands ahead of that,
/// and a zero behind it.
fn check(frame: &mut [u8]) -> Result<&[u8], Fault> {
    let len = cobs::decode_in_place(frame).map_err(|_| Fault::Framing)?;
    let payload = frame.get_mut(..len).ok_or(Fault::Framing)?;
    let (checked, crc) = payload
        .split_last_chunk_mut::<CRC_LEN>()
        .filter(|(checked, _)| !checked.is_empty())
        .ok_or(Fault::Framing)?;
    if CRC.checksum(checked) != u32::from_le_bytes(*crc) {
        return Err(Fault::Crc);
    }
    crc[0] = 0;
    payload.get(..=len - CRC_LEN).ok_or(Fault::Framing)
}

/// The message of a checked frame: its version, its bytes, and a zero.
fn message<M: Message + DeserializeOwned>(payload: &[u8]) -> Result<M, Fault> {
    let (version, message) = payload.split_first().ok_or(Fault::Framing)?;
    let (_, exact) = message.split_last().ok_or(Fault::Framing)?;
    // Left-over bytes mean that the sender knows a longer message.
    let whole = |bytes| match postcard::take_from_bytes(bytes) {
        Ok((message, [])) => Ok(message),
        Ok(_) | Err(_) => Err(Fault::Message),
    };
    match *version {
        ours if ours == M::VERSION => whole(exact),
        // The stream stands at the end: a message of then lacks it, and the zero says so.
        WITHOUT_STREAM if M::VERSION == VERSION => whole(exact).or_else(|_| whole(message)),
        theirs => Err(Fault::Version { theirs }),
    }
}
