//! Fills in what a linked image says of itself (`inm_protocol::image`): revision and checksum.

use anyhow::{Context, Result, ensure};
use inm_protocol::image::{MARK_LEN, checksum, find, set_checksum, set_revision};
use object::Endianness;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};

/// A part of the file that goes into flash.
pub struct Segment {
    /// Where in flash.
    pub address: u64,
    /// Where in the file.
    pub offset: usize,
    /// Bytes.
    pub len: usize,
}

/// The ELF file `image` with the `revision` of its source, and a checksum.
///
/// # Errors
/// It is no ELF file of 32 bits, or does not hold one mark.
pub fn fill_in(mut image: Vec<u8>, revision: &str) -> Result<Vec<u8>> {
    let segments = segments(&image)?;
    let mut marks = Vec::new();
    for segment in &segments {
        let bytes = &image[segment.offset..segment.offset + segment.len];
        marks.extend(find(bytes).map(|at| segment.offset + at));
    }
    ensure!(
        marks.len() == 1,
        "{} marks; expected one, which inm_protocol::image::mark makes",
        marks.len()
    );
    let at = marks[0]..marks[0] + MARK_LEN;
    let mut mark = [0; MARK_LEN];
    mark.copy_from_slice(&image[at.clone()]);
    set_revision(&mut mark, revision);
    image[at.clone()].copy_from_slice(&mark);
    let bytes = |one: &Segment| (one.address, &image[one.offset..one.offset + one.len]);
    set_checksum(&mut mark, checksum(segments.iter().map(bytes)));
    image[at].copy_from_slice(&mark);
    Ok(image)
}

/// The parts of an ELF file that go into flash, ascending.
///
/// # Errors
/// It is no ELF file of 32 bits, or is cut.
pub fn segments(image: &[u8]) -> Result<Vec<Segment>> {
    let header = FileHeader32::<Endianness>::parse(image).context("no ELF file of 32 bits")?;
    let endian = header.endian()?;
    let mut segments = Vec::new();
    for one in header.program_headers(endian, image)? {
        let (offset, len) = one.file_range(endian);
        if one.p_type(endian) != PT_LOAD || len == 0 {
            continue;
        }
        let (offset, len) = (usize::try_from(offset)?, usize::try_from(len)?);
        let end = offset.checked_add(len);
        ensure!(
            end.is_some_and(|end| end <= image.len()),
            "the file ends inside a segment"
        );
        segments.push(Segment {
            address: one.p_paddr(endian).into(),
            offset,
            len,
        });
    }
    segments.sort_by_key(|one| one.address);
    Ok(segments)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_image_is_not_marked() {
        let this = std::env::current_exe().expect("a test is a file");
        let program = std::fs::read(this).expect("readable");
        assert!(fill_in(program, "0").is_err());
    }
}
