//! What an ELF file wants to be loaded, and where.

use object::Endianness;
use object::elf::{self, FileHeader32};
use object::read::elf::{FileHeader, ProgramHeader};

use super::image_error::Problem;
use super::{FLASH_ORIGIN, map};

/// Bytes for the flash, in the file, by their address.
pub type Segments<'a> = [(u64, &'a [u8])];

/// What is to be loaded, ascending. Nothing is copied: a file may name the same bytes any number of
/// times.
///
/// # Errors
/// It is no ELF file for a 32-bit Arm, or is cut.
pub fn segments(data: &[u8]) -> Result<Vec<(u64, &[u8])>, Problem> {
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

/// All of it where loader and programs lie, each segment in one of them, and nothing twice.
///
/// # Errors
/// The first that is not so.
pub fn check_places(segments: &Segments<'_>) -> Result<(), Problem> {
    let mut end = FLASH_ORIGIN;
    for &(address, bytes) in segments {
        let at = address..address + bytes.len() as u64;
        let place = map::PLACES.iter().find(|place| place.contains(&at.start));
        let outside = match place {
            Some(place) if at.end <= place.end => None,
            Some(place) => Some(place.end),
            None => Some(at.start),
        };
        if let Some(outside) = outside {
            return Err(Problem::Outside { at, outside });
        }
        if at.start < end {
            return Err(Problem::Overlap { at: at.start });
        }
        end = at.end;
    }
    Ok(())
}
