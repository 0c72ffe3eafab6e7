//! What an ELF file puts into flash, and whether it is the board's program, whole.

use std::path::Path;

use inm_protocol::image::{About, BOARD, MARK_LEN, checksum, find};
use object::Endianness;
use object::elf::{self, FileHeader32};
use object::read::elf::{FileHeader, ProgramHeader};

use super::image_error::{ImageError, Problem};
use super::{FLASH_ORIGIN, map};

/// A firmware image, read and checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Bytes for the flash, by address, ascending and apart.
    pub segments: Vec<(u64, Vec<u8>)>,
    /// Release of the firmware.
    pub version: String,
    /// Revision of its source, `unknown` where it was built without git.
    pub revision: String,
}

/// Initial stack pointer and reset vector: less cannot start.
const SMALLEST_TABLE: usize = 8;

/// The lowest bit of an address of code: the processor knows Thumb only.
const THUMB: u32 = 1;

/// Bytes for the flash, in the file.
type Segments<'a> = [(u64, &'a [u8])];

impl Image {
    /// Reads the loadable segments of the ELF file at `path`.
    ///
    /// # Errors
    /// [`ImageError`] if the file cannot be read, is not an ELF file for a 32-bit Arm, wants anything
    /// but the flash of the board's chip, or is not the board's program, whole.
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
        check_vectors(&segments)?;
        let about = about(&segments)?;
        let owned = segments.iter().map(|&(at, bytes)| (at, bytes.to_vec()));
        Ok(Self {
            segments: owned.collect(),
            version: about.version.to_owned(),
            revision: about.revision.unwrap_or_default().to_owned(),
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

/// What is to be loaded, ascending. Nothing is copied: a file may name the same bytes any number of
/// times.
fn segments(data: &[u8]) -> Result<Vec<(u64, &[u8])>, Problem> {
    let header = FileHeader32::<Endianness>::parse(data).map_err(Problem::NotElf)?;
    let endian = header.endian().map_err(Problem::NotElf)?;
    let machine = header.e_machine(endian);
    if machine != elf::EM_ARM {
        return Err(Problem::NotArm { machine });
    }
    let mut segments = Vec::new();
    let headers = header.program_headers(endian, data);
    for segment in headers.map_err(Problem::NotElf)? {
        if segment.p_type(endian) != elf::PT_LOAD {
            continue;
        }
        let bytes = segment.data(endian, data);
        let bytes = bytes.map_err(|()| Problem::Cut { len: data.len() })?;
        if !bytes.is_empty() {
            segments.push((u64::from(segment.p_paddr(endian)), bytes));
        }
    }
    segments.sort_by_key(|&(address, _)| address);
    Ok(segments)
}

/// All of it in flash, nothing twice, and the vector table first.
fn check_places(segments: &Segments<'_>) -> Result<(), Problem> {
    let mut end = FLASH_ORIGIN;
    for &(address, bytes) in segments {
        let at = address..address + bytes.len() as u64;
        if !map::FLASH.contains(&at.start) || at.end > map::FLASH.end {
            let outside = if map::FLASH.contains(&at.start) {
                map::FLASH.end
            } else {
                at.start
            };
            return Err(Problem::Outside { at, outside });
        }
        if at.start < end {
            return Err(Problem::Overlap { at: at.start });
        }
        end = at.end;
    }
    let has_table = segments
        .first()
        .is_some_and(|(at, bytes)| *at == FLASH_ORIGIN && bytes.len() >= SMALLEST_TABLE);
    if has_table {
        Ok(())
    } else {
        Err(Problem::NoVectorTable)
    }
}

/// A stack in RAM, and code of the image to begin with.
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

/// What the image says of itself: that it is for the board, and whole.
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
    let (Some(said), Some(_)) = (about.checksum, about.revision) else {
        return Err(Problem::NoMark(
            "it was linked, and has no revision and no checksum yet",
        ));
    };
    let found = checksum(segments.iter().copied());
    if found == said {
        Ok(about)
    } else {
        Err(Problem::Checksum { found, said })
    }
}
