//! From a message to the bytes of its frame.

use serde::Serialize;

use crate::{AXES, BATCH_LEN, VERSION};

/// Look-up tables of the check sum: 16 KiB where speed counts, 1 KiB where flash does.
#[cfg(not(target_os = "none"))]
type Tables = crc::Table<16>;
#[cfg(target_os = "none")]
type Tables = crc::Table<1>;

/// CRC-32 of Ethernet and zlib (ISO-HDLC), over version byte and message.
pub(crate) const CRC: crc::Crc<u32, Tables> = crc::Crc::<u32, Tables>::new(&crc::CRC_32_ISO_HDLC);

/// CRC-32 of the frames, over these bytes: for what is kept as carefully as a frame is sent.
pub fn crc32(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Bytes of the CRC at the end of the payload.
pub(crate) const CRC_LEN: usize = 4;

/// Longest payload (version, message, CRC) of any frame: a full batch with every word flagged.
///
/// Version 1, message tag 1, seq 5, first 10, stamp 10, length 1, codes, length 1, flags of
/// three bytes each, stream 3, CRC 4.
pub const MAX_PAYLOAD: usize = 36 + BATCH_LEN * AXES * 4 + BATCH_LEN * AXES * 3;

/// Longest frame on the wire, COBS overhead (one byte, and one more each 254) and the closing
/// zero included.
pub const MAX_FRAME: usize = MAX_PAYLOAD + 1 + MAX_PAYLOAD / 254 + 1;

/// The byte that ends a frame, and stands nowhere else on the wire.
pub const FRAME_END: u8 = 0;

/// Why a message could not be framed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[non_exhaustive]
pub enum EncodeError {
    /// The output is too short; [`MAX_FRAME`] bytes are always enough.
    NoRoom,
}

impl core::fmt::Display for EncodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the output buffer is too short for the frame")
    }
}

impl core::error::Error for EncodeError {}

/// What a frame can hold.
pub trait Message: Serialize {
    /// Version byte of its frames.
    const VERSION: u8 = VERSION;
}

/// Writes the frame of `message` to the start of `out` and returns its length.
///
/// # Errors
/// [`EncodeError::NoRoom`] if `out` is shorter than the frame.
///
/// ```
/// use inm_protocol::{Command, Decoder, MAX_FRAME, Request, ToBoard, encode};
///
/// let hello = ToBoard::Command(Command { id: 7, request: Request::Identify });
/// let mut frame = [0; MAX_FRAME];
/// let len = encode(&hello, &mut frame)?;
/// let mut decoder = Decoder::new();
/// assert_eq!(decoder.next(&mut &frame[..len]), Some(Ok(hello)));
/// # Ok::<(), inm_protocol::EncodeError>(())
/// ```
pub fn encode<M: Message>(message: &M, out: &mut [u8]) -> Result<usize, EncodeError> {
    let mut payload = [0; MAX_PAYLOAD];
    payload[0] = M::VERSION;
    let body = postcard::to_slice(message, &mut payload[1..MAX_PAYLOAD - CRC_LEN])
        .map_err(|_| EncodeError::NoRoom)?
        .len();
    close(&mut payload, 1 + body, out)
}

/// Writes the frame of `payload`, of which `end` bytes are filled, to the start of `out`, behind the
/// CRC, for which there is room; returns its length.
pub(crate) fn close(payload: &mut [u8], end: usize, out: &mut [u8]) -> Result<usize, EncodeError> {
    let (filled, rest) = payload
        .split_at_mut_checked(end)
        .ok_or(EncodeError::NoRoom)?;
    let room = rest.first_chunk_mut::<CRC_LEN>();
    *room.ok_or(EncodeError::NoRoom)? = CRC.checksum(filled).to_le_bytes();
    let payload = payload.get(..end + CRC_LEN).ok_or(EncodeError::NoRoom)?;
    if out.len() < cobs::max_encoding_length(payload.len()) + 1 {
        return Err(EncodeError::NoRoom);
    }
    let len = cobs::encode(payload, out);
    out[len] = 0;
    Ok(len + 1)
}
