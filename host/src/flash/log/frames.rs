//! The stream to frames: reverse zero-compressing COBS, as defmt sends it (Dirbaio, rzcobs 0.1).

/// Longest frame, bytes: the ring has 1024. More without an end is no log.
const LONGEST: usize = 4096;

/// Bytes on their way to frames.
#[derive(Debug, Default)]
pub(super) struct Frames {
    under_way: Vec<u8>,
}

impl Frames {
    /// Takes bytes as they came; the frames that are complete, `None` of one that is damaged.
    pub(super) fn take(&mut self, bytes: &[u8]) -> Vec<Option<Vec<u8>>> {
        let mut frames = Vec::new();
        for &byte in bytes {
            if byte != 0 {
                self.under_way.push(byte);
                if self.under_way.len() > LONGEST {
                    self.under_way.clear();
                    frames.push(None);
                }
            } else if !self.under_way.is_empty() {
                frames.push(decode(&std::mem::take(&mut self.under_way)));
            }
        }
        frames
    }
}

/// What a frame holds. Its last byte says which of the seven before it are zeros that were left out, and so on to its
/// beginning; runs without zeros have a length instead.
fn decode(frame: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut backwards = frame.iter().rev().copied();
    while let Some(code) = backwards.next() {
        match code {
            0 => return None,
            0x01..=0x7f => {
                for place in 0..7 {
                    bytes.push(match code & (1 << (6 - place)) {
                        0 => backwards.next()?,
                        _ => 0,
                    });
                }
            }
            0x80..=0xfe => {
                bytes.push(0);
                for _ in 0..(code & 0x7f) + 7 {
                    bytes.push(backwards.next()?);
                }
            }
            0xff => {
                for _ in 0..134 {
                    bytes.push(backwards.next()?);
                }
            }
        }
    }
    bytes.reverse();
    Some(bytes)
}
