//! Images of the board that are made up: ELF files with a loader and a program for each slot.

#![allow(dead_code)] // each test file uses its part

use inm_protocol::crc32;
use inm_protocol::image::{MARK_LEN, checksum, mark, set_checksum, set_revision};
use inm_protocol::slot::{FLASH, HEADER, Header, SLOT_STARTS};

/// `e_machine` of Arm.
pub const ARM: u16 = 40;

/// A 32-bit little-endian ELF file with loadable segments at these addresses.
pub fn elf_of(machine: u16, segments: &[(u32, &[u8])]) -> Vec<u8> {
    let (header, program_header) = (52u32, 32u32);
    let mut offset = header + program_header * segments.len() as u32;
    let mut file = b"\x7fELF\x01\x01\x01".to_vec();
    file.resize(16, 0);
    file.extend(2u16.to_le_bytes()); // executable
    file.extend(machine.to_le_bytes());
    file.extend(1u32.to_le_bytes());
    file.extend((FLASH + 1).to_le_bytes()); // entry
    file.extend(header.to_le_bytes()); // program headers
    file.extend([0; 4]); // no section headers
    file.extend([0; 4]); // flags
    for half in [52u16, 32, segments.len() as u16, 40, 0, 0] {
        file.extend(half.to_le_bytes());
    }
    for (address, bytes) in segments {
        let len = bytes.len() as u32;
        for word in [1, offset, *address, *address, len, len, 5, 4] {
            file.extend(word.to_le_bytes());
        }
        offset += len;
    }
    for (_, bytes) in segments {
        file.extend(*bytes);
    }
    file
}

/// What is to be loaded, by address.
pub type Parts = Vec<(u32, Vec<u8>)>;

/// An ELF file for Arm that loads these.
pub fn elf(parts: &Parts) -> Vec<u8> {
    let parts: Vec<_> = parts.iter().map(|(at, bytes)| (*at, &bytes[..])).collect();
    elf_of(ARM, &parts)
}

/// A program for `platform` that lies at `address`: vectors, its mark, and as many bytes more, with its
/// checksum.
pub fn program(platform: &str, release: &str, address: u32, more: usize) -> Vec<u8> {
    let mut mark = mark(platform, release);
    set_revision(&mut mark, "0123456789ab");
    let with = |mark: &[u8; MARK_LEN]| {
        let stack = 0x2000_8000_u32.to_le_bytes();
        let reset = (address + 8 + 1).to_le_bytes();
        let more = (0..more as u32).map(|k| (k.wrapping_mul(0x9E37_79B9) >> 24) as u8);
        let more: Vec<u8> = more.collect();
        [&stack[..], &reset, &[0x55; 40], mark, &more].concat()
    };
    let blank = with(&mark);
    set_checksum(&mut mark, checksum([(address.into(), &blank[..])]));
    with(&mark)
}

/// A header of a program of this length and checksum.
pub fn header(program: &[u8], number: u32) -> Vec<u8> {
    let mut whole = program.to_vec();
    whole.resize(program.len().next_multiple_of(4), 0xff);
    let header = Header {
        number,
        length: whole.len() as u32,
        crc: crc32(&whole),
    };
    header
        .words()
        .into_iter()
        .flat_map(u32::to_le_bytes)
        .collect()
}

/// A whole image: the loader, and for each slot a header and a program with `more` bytes.
pub fn image(platform: &str, release: &str, more: usize) -> Parts {
    let mut parts = vec![(FLASH, program(platform, release, FLASH, 20))];
    for (number, start) in [1, 0].into_iter().zip(SLOT_STARTS) {
        let program = program(platform, release, start + HEADER, more);
        parts.push((start, header(&program, number)));
        parts.push((start + HEADER, program));
    }
    parts
}
