//! What a firmware image says of itself: for which machine, of which source, and whether it is whole.
//!
//! ```text
//!   offset  0       16        32       48        80        84
//!           magic   platform  version  revision  checksum
//! ```
//!
//! Platform and version are linked in. Revision and checksum are written into the linked file by
//! `cargo xtask firmware`: the one is of the source at that moment, the other covers all the rest.
//! `inm flash` programs nothing without them.

use core::ops::Range;

use crate::frame::CRC;

/// What the board's image calls its machine.
pub const BOARD: &str = "stm32f405";

/// What the image for QEMU's model of the board calls its machine.
pub const QEMU: &str = "qemu";

/// Bytes of a mark.
pub const MARK_LEN: usize = 84;

/// Begins a mark. Not ASCII at both ends, so that no text of a program holds it.
const MAGIC: [u8; 16] = *b"\xe7inm image, 01\xe7\0";

const PLATFORM: Range<usize> = 16..32;
const VERSION: Range<usize> = 32..48;
const REVISION: Range<usize> = 48..80;
const CHECKSUM: Range<usize> = 80..MARK_LEN;

/// What flash holds where nothing was programmed, and a mark where nothing was filled in.
const BLANK: u8 = 0xff;

/// The mark that is linked into an image for `platform` (at most 16 bytes) of release `version` (at
/// most 16); longer ones are cut.
#[must_use]
pub const fn mark(platform: &str, version: &str) -> [u8; MARK_LEN] {
    let mut bytes = [BLANK; MARK_LEN];
    copy(&mut bytes, 0..PLATFORM.start, &MAGIC);
    copy(&mut bytes, PLATFORM, platform.as_bytes());
    copy(&mut bytes, VERSION, version.as_bytes());
    bytes
}

/// Copies as much of `text` as `place` holds, zeros behind it.
const fn copy(bytes: &mut [u8; MARK_LEN], place: Range<usize>, text: &[u8]) {
    let mut at = place.start;
    while at < place.end {
        let from = at - place.start;
        bytes[at] = if from < text.len() { text[from] } else { 0 };
        at += 1;
    }
}

/// Where in `bytes` the first mark begins.
#[must_use]
pub fn find(bytes: &[u8]) -> Option<usize> {
    let mut places = bytes.windows(MARK_LEN);
    places.position(|place| place.starts_with(&MAGIC))
}

/// A mark, read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct About<'a> {
    /// Machine that the image is for: [`BOARD`] or [`QEMU`].
    pub platform: &'a str,
    /// Release of the firmware.
    pub version: &'a str,
    /// Revision of the source; `None` where it was not filled in.
    pub revision: Option<&'a str>,
    /// Checksum of the image; `None` where it was not filled in.
    pub checksum: Option<u32>,
}

impl<'a> About<'a> {
    /// Reads the mark that `bytes` begin with; `None` if they do not, or its texts are none.
    #[must_use]
    pub fn read(bytes: &'a [u8]) -> Option<Self> {
        let mark = bytes
            .get(..MARK_LEN)
            .filter(|mark| mark.starts_with(&MAGIC))?;
        let text = |place: Range<usize>| {
            let field = &mark[place];
            let end = field.iter().position(|&byte| byte == 0);
            core::str::from_utf8(&field[..end.unwrap_or(field.len())]).ok()
        };
        let filled = |place: Range<usize>| mark[place].iter().any(|&byte| byte != BLANK);
        let checksum = mark[CHECKSUM].first_chunk().copied();
        Some(Self {
            platform: text(PLATFORM)?,
            version: text(VERSION)?,
            revision: match filled(REVISION) {
                true => Some(text(REVISION)?),
                false => None,
            },
            checksum: checksum
                .filter(|_| filled(CHECKSUM))
                .map(u32::from_le_bytes),
        })
    }
}

/// Fills in the revision of the mark that `mark` begins with; of more than 32 bytes, the first.
pub fn set_revision(mark: &mut [u8; MARK_LEN], revision: &str) {
    copy(mark, REVISION, revision.as_bytes());
}

/// Fills in the checksum of the mark.
pub fn set_checksum(mark: &mut [u8; MARK_LEN], checksum: u32) {
    mark[CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
}

/// Checksum (CRC-32 of the frames) of the flash from the first segment to the end of the last:
/// `segments` are addresses and bytes, ascending and apart; between them the flash is blank. The
/// checksum in the first mark counts as blank, too.
#[must_use]
pub fn checksum<'a>(segments: impl IntoIterator<Item = (u64, &'a [u8])>) -> u32 {
    let mut digest = CRC.digest();
    let (mut at, mut marked) = (None, false);
    for (address, bytes) in segments {
        for _ in at.unwrap_or(address)..address {
            digest.update(&[BLANK]);
        }
        at = Some(address + bytes.len() as u64);
        match find(bytes).filter(|_| !marked) {
            Some(mark) => {
                marked = true;
                digest.update(&bytes[..mark + CHECKSUM.start]);
                digest.update(&[BLANK; CHECKSUM.end - CHECKSUM.start]);
                digest.update(&bytes[mark + CHECKSUM.end..]);
            }
            None => digest.update(bytes),
        }
    }
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_found_and_read_back() {
        let mut mark = mark(BOARD, "1.2.3");
        let linked = About::read(&mark).expect("a mark");
        assert_eq!((linked.platform, linked.version), (BOARD, "1.2.3"));
        assert_eq!((linked.revision, linked.checksum), (None, None));
        set_revision(&mut mark, "0123456789ab, changed");
        set_checksum(&mut mark, 0x1234_5678);
        let image = [&[0xe7; 20][..], &mark, &[1, 2, 3]].concat();
        assert_eq!(find(&image), Some(20));
        let about = About::read(&image[20..]).expect("a mark");
        assert_eq!(about.revision, Some("0123456789ab, changed"));
        assert_eq!(about.checksum, Some(0x1234_5678));
        assert_eq!(find(&image[21..]), None);
        assert_eq!(About::read(&image), None);
    }

    #[test]
    fn a_checksum_covers_all_but_itself() {
        let mut mark = mark(QEMU, "1");
        let blank = [&[7; 9][..], &mark, &[8; 5]].concat();
        let whole = [&blank[..], &[BLANK; 6], &[9; 4]].concat();
        let sum = CRC.checksum(&whole);
        let split = |image: &[u8]| checksum([(100, image), (100 + 98 + 6, &[9; 4][..])]);
        assert_eq!(blank.len(), 98);
        assert_eq!(split(&blank), sum);
        set_checksum(&mut mark, sum);
        let marked = [&[7; 9][..], &mark, &[8; 5]].concat();
        assert_eq!(split(&marked), sum);
        for at in (0..9).chain([9 + PLATFORM.start, 9 + REVISION.start, 97]) {
            let mut damaged = marked.clone();
            damaged[at] ^= 1;
            assert_ne!(split(&damaged), sum, "byte {at}");
        }
    }
}
