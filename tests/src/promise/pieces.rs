//! Frames with a right check sum around any bytes: without it nothing behind the decoder is ever tried.

use inm_protocol::{MAX_FRAME, MAX_PAYLOAD, Message, encode};
use serde::ser::{Serialize, SerializeTuple, Serializer};

/// Bytes that stand in a frame as they are.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

impl Message for Raw<'_> {}

/// The pieces that `bytes` are cut into, each in a frame of its own. Ahead of each piece stands its
/// length, two bytes, the lower first.
pub fn framed(mut bytes: &[u8]) -> Vec<u8> {
    let mut stream = Vec::new();
    while let Some((length, rest)) = bytes.split_first_chunk() {
        // Whatever stands there, within what a frame holds.
        let length = usize::from(u16::from_le_bytes(*length)) % MAX_PAYLOAD;
        let (piece, rest) = rest.split_at(length.min(rest.len()));
        let mut frame = [0; MAX_FRAME];
        if let Ok(length) = encode(&Raw(piece), &mut frame) {
            stream.extend_from_slice(&frame[..length]);
        }
        bytes = rest;
    }
    stream
}

/// The stream that stands for `bytes`: as they are, or, where the first of them is odd, the rest
/// [`framed`].
pub fn stream(bytes: &[u8]) -> Vec<u8> {
    match bytes.split_first() {
        Some((first, rest)) if first % 2 == 1 => framed(rest),
        Some((_, rest)) => rest.to_vec(),
        None => Vec::new(),
    }
}
