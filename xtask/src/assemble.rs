//! The board's image: the loader and the program for both slots, in one ELF file.
//!
//! ```text
//!   program linked for slot 0 --+-- its own segments, symbols and sections
//!   its header                --+
//!   the loader                --+--> one file: a probe writes all of it, `inm board update` takes of it
//!   program linked for slot 1 --+    the program for the slot that is free
//!   its header                --+
//! ```
//!
//! What is added has no symbols; a debugger knows the program of slot 0, which is the one that starts.

use anyhow::{Context, Result, ensure};
use inm_protocol::crc32;
use inm_protocol::slot::{HEADER, Header, LOADER_PLACE, ROOM, SLOT_STARTS};

use crate::mark::segments;

/// What flash holds where nothing is written.
const BLANK: u8 = 0xff;

/// What stands in a header behind its words: the program has proved itself. Who has a probe has another
/// way back.
const PROVED: u32 = 0;

/// Numbers of the programs by slot: the first is the newer, and starts.
const NUMBERS: [u32; 2] = [1, 0];

/// Where the fields of an ELF header of 32 bits are that say where its program headers are.
const TABLE_AT: usize = 28;
const TABLE_LEN: usize = 44;

/// Bytes of a program header, of which `PT_LOAD` is type 1.
const ENTRY: usize = 32;
const LOAD: u32 = 1;

/// Bytes for the flash, and where.
struct Part {
    address: u32,
    bytes: Vec<u8>,
}

/// One image of a program linked for each slot, and of the loader; all of them marked.
///
/// # Errors
/// One of them does not lie where it should, or has no room there.
pub fn board(programs: [Vec<u8>; 2], loader: &[u8]) -> Result<Vec<u8>> {
    let loader = whole(loader)?;
    let end = loader.address as usize + loader.bytes.len();
    ensure!(
        loader.address == LOADER_PLACE.start && end <= LOADER_PLACE.end as usize,
        "the loader lies at {:#010x} to {end:#010x}; expected within {LOADER_PLACE:#010x?}",
        loader.address
    );
    let [first, second] = [0, 1].map(|slot| {
        let program = whole(&programs[slot]).with_context(|| format!("slot {slot}"))?;
        let header = header(&program, slot)?;
        anyhow::Ok((header, program))
    });
    let ((first, _), (second, program)) = (first?, second?);
    let [image, _] = programs;
    attach(image, &[loader, first, second, program])
}

/// All that an image puts into flash, from the start of that: for programmers that know no ELF, or look at its
/// sections, which the added parts have none of.
///
/// # Errors
/// It is no ELF file.
pub fn flat(image: &[u8]) -> Result<Vec<u8>> {
    Ok(whole(image)?.bytes)
}

/// The header of a program in a slot.
fn header(program: &Part, slot: usize) -> Result<Part> {
    let (address, length) = (program.address, program.bytes.len() as u32);
    let start = SLOT_STARTS[slot];
    ensure!(
        address == start + HEADER && length <= ROOM,
        "the program of slot {slot} has {length} bytes at {address:#010x}; expected up to {ROOM} at {:#010x}",
        start + HEADER
    );
    let header = Header {
        number: NUMBERS[slot],
        length,
        crc: crc32(&program.bytes),
    };
    let words = header.words().into_iter().chain([PROVED]);
    Ok(Part {
        address: start,
        bytes: words.flat_map(u32::to_le_bytes).collect(),
    })
}

/// All that an ELF file puts into flash, as it lies there, up to a multiple of four bytes.
fn whole(image: &[u8]) -> Result<Part> {
    let segments = segments(image)?;
    let first = segments.first().context("nothing to load")?.address;
    let mut bytes = Vec::new();
    for one in segments {
        bytes.resize((one.address - first) as usize, BLANK);
        bytes.extend(&image[one.offset..one.offset + one.len]);
    }
    bytes.resize(bytes.len().next_multiple_of(4), BLANK);
    Ok(Part {
        address: u32::try_from(first)?,
        bytes,
    })
}

/// Adds parts to an ELF file: their bytes at its end, and behind them a table of all program headers in the
/// place of the one it had.
fn attach(mut image: Vec<u8>, parts: &[Part]) -> Result<Vec<u8>> {
    let short = "the file ends inside its header";
    let at = image.get(TABLE_AT..).and_then(<[u8]>::first_chunk);
    let at = u32::from_le_bytes(*at.context(short)?) as usize;
    let entries = image.get(TABLE_LEN..).and_then(<[u8]>::first_chunk);
    let entries = u16::from_le_bytes(*entries.context(short)?);
    let table = image.get(at..at + ENTRY * usize::from(entries));
    let mut table = table.context("the file ends inside its table")?.to_vec();
    for Part { address, bytes } in parts {
        image.resize(image.len().next_multiple_of(4), 0);
        let (offset, len) = (u32::try_from(image.len())?, u32::try_from(bytes.len())?);
        // Type, offset, address twice, length twice, readable, alignment.
        for word in [LOAD, offset, *address, *address, len, len, 4, 4] {
            table.extend(word.to_le_bytes());
        }
        image.extend(bytes);
    }
    image.resize(image.len().next_multiple_of(4), 0);
    let table_at = u32::try_from(image.len())?;
    let entries = entries + u16::try_from(parts.len())?;
    image[TABLE_AT..TABLE_AT + 4].copy_from_slice(&table_at.to_le_bytes());
    image[TABLE_LEN..TABLE_LEN + 2].copy_from_slice(&entries.to_le_bytes());
    image.extend(table);
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ELF file for Arm that loads these bytes.
    fn elf(parts: &[Part]) -> Vec<u8> {
        let mut file = b"\x7fELF\x01\x01\x01".to_vec();
        file.resize(52, 0);
        file[16] = 2;
        file[18] = 40;
        file[20] = 1;
        file[TABLE_AT] = 52;
        for (at, size) in [(40, 52), (42, ENTRY as u8), (46, 40)] {
            file[at] = size;
        }
        attach(file, parts).expect("an ELF file")
    }

    fn program(slot: usize) -> Vec<u8> {
        let address = SLOT_STARTS[slot] + HEADER;
        let [vectors, code] = [(address, 8), (address + 16, 7)].map(|(address, len)| Part {
            address,
            bytes: vec![0x51 + slot as u8; len],
        });
        elf(&[vectors, code])
    }

    fn loader() -> Vec<u8> {
        elf(&[Part {
            address: LOADER_PLACE.start,
            bytes: vec![0x50; 20],
        }])
    }

    #[test]
    fn one_file_has_the_loader_and_a_program_with_its_header_for_each_slot() {
        let image = board([program(0), program(1)], &loader()).expect("it fits");
        let found = segments(&image).expect("an ELF file");
        let places = found.iter().map(|one| (one.address as u32, one.len));
        let [a, b] = SLOT_STARTS;
        let flat = flat(&image).expect("an ELF file");
        let slot = (b + HEADER - LOADER_PLACE.start) as usize;
        assert_eq!((flat[0], flat[20], flat[slot]), (0x50, BLANK, 0x52));
        let expected = [
            (LOADER_PLACE.start, 20),
            (a, 24),
            (a + HEADER, 8),
            (a + HEADER + 16, 7),
            (b, 24),
            (b + HEADER, 24),
        ];
        assert_eq!(places.collect::<Vec<_>>(), expected);
        let bytes = |k: usize| &image[found[k].offset..found[k].offset + found[k].len];
        assert_eq!(bytes(5)[..16], [&[0x52; 8][..], &[BLANK; 8]].concat());
        for (k, slot) in [(1, 0), (4, 1)] {
            let words = bytes(k)
                .as_chunks()
                .0
                .iter()
                .copied()
                .map(u32::from_le_bytes);
            let words: Vec<u32> = words.collect();
            let header = Header::read(*words.first_chunk().expect("five words"));
            let program = whole(&program(slot)).expect("an ELF file");
            let header = header.expect("a header");
            assert_eq!((header.length, header.crc), (24, crc32(&program.bytes)));
            assert_eq!((header.number, words[5]), (NUMBERS[slot], PROVED));
        }
    }

    #[test]
    fn what_was_linked_for_another_place_is_not_assembled() {
        let swapped = board([program(1), program(0)], &loader());
        let error = swapped.expect_err("it lies elsewhere").to_string();
        assert!(error.contains("expected up to"), "{error}");
        let error = board([program(0), program(1)], &program(0)).expect_err("no loader");
        assert!(error.to_string().contains("the loader lies at"), "{error}");
    }
}
