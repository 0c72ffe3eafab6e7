//! What an ELF file puts into flash, and whether it is the board's image, whole: its loader, and its program
//! for each slot.

use std::path::Path;

use inm_protocol::crc32;
use inm_protocol::image::{About, BOARD, MARK_LEN, checksum, find};
use inm_protocol::slot::{HEADER, HEADER_WORDS, Header, SLOT_STARTS, SLOTS};

use super::image_error::{ImageError, Problem};
use super::segments::{Segments, check_places, segments};
use super::{FLASH_ORIGIN, map};

/// A firmware image, read and checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Bytes for the flash, by address, ascending and apart.
    pub segments: Vec<(u64, Vec<u8>)>,
    /// The program, by slot.
    pub programs: [Program; SLOTS],
    /// Release of the firmware.
    pub version: String,
    /// Revision of its source, `unknown` where it was built without git.
    pub revision: String,
}

/// The program as it lies in a slot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// Address of its vector table, with which it begins.
    pub address: u32,
    /// Its bytes; a multiple of four.
    pub bytes: Vec<u8>,
}

/// Initial stack pointer and reset vector: less cannot start.
const SMALLEST_TABLE: usize = 8;

/// The lowest bit of an address of code: the processor knows Thumb only.
const THUMB: u32 = 1;

/// What flash holds where nothing is written.
const BLANK: u8 = 0xff;

impl Image {
    /// Reads the loadable segments of the ELF file at `path`.
    ///
    /// # Errors
    /// [`ImageError`] if the file cannot be read, is not an ELF file for a 32-bit Arm, wants anything
    /// but the flash of the board's chip, or is not the board's image, whole.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let data = std::fs::read(path).map_err(Problem::Io);
        data.and_then(|data| Self::parse(&data))
            .map_err(|problem| ImageError {
                path: path.to_owned(),
                problem,
            })
    }

    /// As [`Image::read`], from bytes.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn parse(data: &[u8]) -> Result<Self, Problem> {
        let segments = segments(data)?;
        check_places(&segments)?;
        let [loader, first, second] = map::PLACES.map(|place| {
            let within = segments.iter().filter(|(at, _)| place.contains(at));
            within.copied().collect::<Vec<_>>()
        });
        check_loader(&loader)?;
        let (first, about) = program(&first, 0)?;
        let (second, other) = program(&second, 1)?;
        if about != other {
            let [first, second] =
                [about, other].map(|(version, revision)| format!("{version} of {revision}"));
            return Err(Problem::Mixed { first, second });
        }
        let (version, revision) = about;
        let owned = segments.iter().map(|&(at, bytes)| (at, bytes.to_vec()));
        Ok(Self {
            segments: owned.collect(),
            programs: [first, second],
            version,
            revision,
        })
    }

    /// What the image says of itself, and where that lies in flash; `None` of one that was made by hand.
    pub fn mark(&self) -> Option<(u64, &[u8])> {
        self.segments.iter().find_map(|(address, bytes)| {
            let at = find(bytes)?;
            let mark = bytes.get(at..at + MARK_LEN)?;
            Some((address + at as u64, mark))
        })
    }

    /// Bytes to program.
    pub fn len(&self) -> usize {
        self.segments.iter().map(|(_, bytes)| bytes.len()).sum()
    }

    /// Whether there is nothing to program; never so for an image that was read.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl std::fmt::Display for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "firmware {} of revision {}", self.version, self.revision)
    }
}

impl Program {
    /// What the program says of itself, and where that lies in flash; `None` of one that was made by hand.
    pub fn mark(&self) -> Option<(u32, &[u8])> {
        let at = find(&self.bytes)?;
        let mark = self.bytes.get(at..at + MARK_LEN)?;
        Some((self.address + at as u32, mark))
    }
}

/// The loader is one, for this board, and whole.
fn check_loader(segments: &Segments<'_>) -> Result<(), Problem> {
    let has_table = segments
        .first()
        .is_some_and(|(at, bytes)| *at == FLASH_ORIGIN && bytes.len() >= SMALLEST_TABLE);
    if !has_table {
        return Err(Problem::NoVectorTable);
    }
    check_vectors(segments)?;
    let about = about(segments)?;
    let found = checksum(segments.iter().copied());
    match about.checksum {
        Some(said) if said == found => Ok(()),
        said => Err(Problem::Checksum {
            found,
            said: said.unwrap_or_default(),
        }),
    }
}

/// The program of a slot, and its release and revision: what the header says is there, whole, and for this
/// board.
fn program(segments: &Segments<'_>, slot: usize) -> Result<(Program, (String, String)), Problem> {
    let start = u64::from(SLOT_STARTS[slot]);
    let missing = || Problem::NoProgram { slot, start };
    let (&(at, header), program) = segments.split_first().ok_or_else(missing)?;
    let words = header.as_chunks().0.first_chunk::<HEADER_WORDS>();
    let words = words.filter(|_| at == start).ok_or_else(missing)?;
    let header = Header::read(words.map(u32::from_le_bytes)).ok_or_else(missing)?;
    let address = start + u64::from(HEADER);
    if program
        .first()
        .is_none_or(|&(at, bytes)| at != address || bytes.len() < SMALLEST_TABLE)
    {
        return Err(missing());
    }
    let mut bytes = Vec::new();
    for &(at, part) in program {
        bytes.resize((at - address) as usize, BLANK);
        bytes.extend(part);
    }
    bytes.resize(bytes.len().next_multiple_of(4), BLANK);
    check_vectors(program)?;
    let about = about(program)?;
    let found = crc32(&bytes);
    if found != header.crc || bytes.len() != header.length as usize {
        return Err(Problem::Checksum {
            found,
            said: header.crc,
        });
    }
    let told = [about.version, about.revision.unwrap_or_default()].map(str::to_owned);
    let address = address as u32;
    Ok((Program { address, bytes }, told.into()))
}

/// A stack in RAM, and code of the same part to begin with.
fn check_vectors(segments: &Segments<'_>) -> Result<(), Problem> {
    let word = |at: usize| {
        let bytes = segments
            .first()
            .and_then(|(_, bytes)| bytes[at..].first_chunk());
        bytes.map_or(0, |bytes| u32::from_le_bytes(*bytes))
    };
    let (stack, reset) = (word(0), word(4));
    // A stack grows down from the end of its memory.
    let top = u64::from(stack).wrapping_sub(1);
    if !map::RAM.contains(&top) || !stack.is_multiple_of(4) {
        return Err(Problem::Vector {
            what: "the initial stack pointer",
            value: stack,
            expected: "a multiple of four in the RAM",
        });
    }
    let code = u64::from(reset & !THUMB);
    let holds = |(at, bytes): &(u64, &[u8])| (*at..*at + bytes.len() as u64).contains(&code);
    if reset & THUMB == 0 || !segments.iter().any(holds) {
        return Err(Problem::Vector {
            what: "the reset vector",
            value: reset,
            expected: "an address in the image, with its lowest bit set",
        });
    }
    Ok(())
}

/// What a part of the image says of itself: that it is for the board, and was finished.
fn about<'a>(segments: &Segments<'a>) -> Result<About<'a>, Problem> {
    let marks = segments
        .iter()
        .filter_map(|&(_, bytes)| About::read(&bytes[find(bytes)?..]));
    let marks: Vec<About<'a>> = marks.collect();
    let about = match marks[..] {
        [about] => about,
        [] => return Err(Problem::NoMark("it has no mark of this project")),
        _ => return Err(Problem::NoMark("it has more than one mark")),
    };
    if about.platform != BOARD {
        return Err(Problem::Platform {
            platform: about.platform.to_owned(),
        });
    }
    if about.checksum.is_none() || about.revision.is_none() {
        return Err(Problem::NoMark(
            "it was linked, and has no revision and no checksum yet",
        ));
    }
    Ok(about)
}
