//! The frozen hello: what a board of any version says of itself to a host of any version.
//!
//! ```text
//!   payload = version (1) | "inmhello" (8) | length (1) | serial (3 x u32, little endian)
//!             | length (1), firmware | length (1), platform | whatever a later board adds | CRC-32
//! ```
//!
//! No byte of it ever changes its meaning; a later board may add some at the end, within the first
//! length. A message of the present version begins with a variant's number, which is far below the
//! first letter of the magic, so that neither is taken for the other.

use heapless::String;

use crate::frame::{EncodeError, close};

/// Begins a hello, behind the version. Its first byte is a number that no message has.
pub const HELLO: [u8; 8] = *b"inmhello";

/// Bytes of the serial number.
const SERIAL: usize = 12;

/// Longest firmware version, and longest name of a platform, in bytes: those of an identity.
const TEXT: usize = 16;

/// Longest payload of a hello: version, magic, length, serial, two texts with their lengths, CRC.
const MAX_HELLO: usize = 1 + HELLO.len() + 1 + SERIAL + 2 * (1 + TEXT) + 4;

/// What a board of any version says of itself, ahead of its identity and to any intact frame of
/// another version.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Hello {
    /// The protocol version that the board speaks.
    pub version: u8,
    /// Unique number of the microcontroller.
    pub serial: [u32; 3],
    /// Firmware version, as in its Cargo.toml; what is longer than 16 bytes is cut.
    pub firmware: String<TEXT>,
    /// What the image was built for: `stm32f405`, `qemu`, `virtual`; cut likewise.
    pub platform: String<TEXT>,
}

impl Hello {
    /// Writes the frame of this hello to the start of `out` and returns its length; 62 bytes are
    /// enough.
    ///
    /// # Errors
    /// [`EncodeError::NoRoom`] if `out` is shorter than the frame.
    pub fn encode(&self, out: &mut [u8]) -> Result<usize, EncodeError> {
        let [firmware, platform] = [&self.firmware, &self.platform].map(|text| text.as_bytes());
        let length = (SERIAL + 2 + firmware.len() + platform.len()) as u8;
        let [x, y, z] = self.serial.map(u32::to_le_bytes);
        let mut payload = [0; MAX_HELLO];
        let mut end = 0;
        for part in [
            &[self.version][..],
            &HELLO,
            &[length],
            &x,
            &y,
            &z,
            &[firmware.len() as u8],
            firmware,
            &[platform.len() as u8],
            platform,
        ] {
            let room = payload.get_mut(end..end + part.len());
            room.ok_or(EncodeError::NoRoom)?.copy_from_slice(part);
            end += part.len();
        }
        close(&mut payload, end, out)
    }

    /// The hello that a checked frame holds, of which this is version and message; `None` if it is
    /// none.
    pub(crate) fn of(version: u8, message: &[u8]) -> Option<Self> {
        let (&length, rest) = message.strip_prefix(&HELLO)?.split_first()?;
        let body = rest.get(..usize::from(length))?;
        let (serial, texts) = body.split_first_chunk::<SERIAL>()?;
        let word = |at: usize| {
            let bytes = serial.get(at..at + 4)?.try_into().ok()?;
            Some(u32::from_le_bytes(bytes))
        };
        let (firmware, texts) = text(texts)?;
        let (platform, _) = text(texts)?;
        Some(Self {
            version,
            serial: [word(0)?, word(4)?, word(8)?],
            firmware,
            platform,
        })
    }
}

/// A text behind its length, cut to what there is room for, and what follows it.
fn text(bytes: &[u8]) -> Option<(String<TEXT>, &[u8])> {
    let (&length, rest) = bytes.split_first()?;
    let (text, rest) = rest.split_at_checked(usize::from(length))?;
    let mut short = String::new();
    for character in core::str::from_utf8(text).ok()?.chars() {
        if short.push(character).is_err() {
            break;
        }
    }
    Some((short, rest))
}
