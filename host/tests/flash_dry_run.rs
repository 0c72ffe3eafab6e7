//! Programming against probe-rs's fake probe: everything but the wire to the chip.
#![cfg(feature = "flash")]

use std::path::Path;

use inm_host::internals::flash::{
    CHIP, Image, Line, LogError, LogTable, follow, program, ring, shipped,
};
use inm_protocol::image::BOARD;
use object::{Object, ObjectSymbol};
use probe_rs::Permissions;
use probe_rs::integration::FakeProbe;

#[path = "image/mod.rs"]
mod image;

/// A loader, and programs of `len` bytes and a few.
fn image(len: usize) -> Image {
    let parts = image::image(BOARD, "1.0.0", len);
    Image::parse(&image::elf(&parts)).expect("a sound image")
}

#[test]
fn an_image_is_laid_out_for_the_boards_chip() {
    let probe = FakeProbe::with_mocked_core().into_probe();
    let mut session = probe
        .attach(CHIP, Permissions::default())
        .expect("the fake probe attaches");
    let image = image(20_000);
    program(&mut session, &image, true, |_| {}).expect("the dry run passes");
}

#[test]
fn an_image_beyond_the_chips_flash_is_refused() {
    let probe = FakeProbe::with_mocked_core().into_probe();
    let mut session = probe
        .attach(CHIP, Permissions::default())
        .expect("the fake probe attaches");
    let mut image = image(20_000);
    // The STM32F405RG has 1 MiB.
    image.segments.push((0x0810_0000, vec![0x55]));
    let error = program(&mut session, &image, true, |_| {}).expect_err("it does not fit");
    assert!(error.to_string().contains(CHIP), "{error}");
}

#[test]
fn a_missing_file_is_an_error_of_its_own() {
    let error = Image::read(Path::new("no-such-image.elf")).expect_err("it is not there");
    assert!(error.to_string().contains("no-such-image.elf"), "{error}");
}

/// Where the ring of the log and its bytes lie in the fake board's RAM.
const RING: u32 = 0x2000_8008;
const BYTES: u32 = 0x2000_9000;

/// An ELF file whose RAM holds a ring with these bytes in it.
fn board_with(bytes: &[u8]) -> Vec<u8> {
    let mut header = b"SEGGER RTT\0\0\0\0\0\0".to_vec();
    // One channel up, none down; its name (none), buffer, size, written, read, mode.
    for word in [1, 0, 0, BYTES, 1024, bytes.len() as u32, 0, 1] {
        header.extend(word.to_le_bytes());
    }
    header.resize(64, 0);
    let mut ring = bytes.to_vec();
    ring.resize(1028, 0);
    let mut file = b"\x7fELF\x01\x01\x01".to_vec();
    file.resize(16, 0);
    file.extend([2, 0, 40, 0]);
    let (begin, sections) = (52 + 2 * 32, header.len() + ring.len());
    for word in [1, 0x0800_0001, 52, begin + sections as u32, 0] {
        file.extend(u32::to_le_bytes(word));
    }
    for half in [52_u16, 32, 2, 40, 4, 3] {
        file.extend(half.to_le_bytes());
    }
    let mut offset = begin;
    // The fake board takes segments that hold a section.
    let mut table = vec![0; 40];
    for (address, part) in [(RING, &header), (BYTES, &ring)] {
        let len = part.len() as u32;
        for word in [1, offset, address, address, len, len, 6, 4] {
            file.extend(word.to_le_bytes());
        }
        for word in [0, 1, 2, address, offset, len, 0, 0, 4, 0] {
            table.extend(u32::to_le_bytes(word));
        }
        offset += len;
    }
    // Names of the sections: none, a zero of the file's own beginning.
    for word in [0, 3, 0, 0, 8, 1, 0, 0, 1, 0] {
        table.extend(u32::to_le_bytes(word));
    }
    [file, header, ring, table].concat()
}

#[test]
fn the_log_is_read_out_of_a_running_board() {
    let table = LogTable::parse(shipped::BOARD, Path::new("shipped")).expect("a log table");
    let number = line_number("restart by command");
    let [low, high] = number.to_le_bytes();
    assert_eq!(high, 0, "a small number");
    // Number, and a time of 0x01020304 us: seven bytes with zeros at 1 and 6, three with zeros at all.
    let frame = [low, 4, 3, 2, 1, 0b100_0010, 0b111_1111, 0];
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("ram.elf");
    std::fs::write(&file, board_with(&frame)).expect("writable");
    let probe = FakeProbe::with_mocked_core_and_binary(&file).into_probe();
    let mut session = probe
        .attach(CHIP, Permissions::default())
        .expect("the fake probe attaches");
    let said = std::cell::RefCell::new(Vec::<Line>::new());
    let stop = || !said.borrow().is_empty();
    let told: Result<(), LogError> = follow(&mut session, (&table, RING.into()), stop, |line| {
        said.borrow_mut().push(line);
        Ok(())
    });
    told.expect("a log");
    let said = said.into_inner();
    assert_eq!(said[0].what, "restart by command");
    let up_s = said[0].up_s.expect("the board's time");
    assert!(
        (up_s - f64::from(0x0102_0304) * 1e-6).abs() < 1e-9,
        "{up_s}"
    );
}

/// The number of a line of the shipped image's log: the address of the symbol that is named like it.
fn line_number(text: &str) -> u16 {
    let file = object::File::parse(shipped::BOARD).expect("an ELF file");
    let named = file.symbols().find(|symbol| {
        let name = symbol.name().unwrap_or_default();
        name.contains(&format!("\"data\":\"{text}\""))
    });
    named.expect("a line of the log").address() as u16
}

#[test]
fn the_ring_of_the_shipped_image_lies_in_the_ram() {
    let at = ring(shipped::BOARD).expect("its symbol");
    assert!((0x2000_0000..0x2002_0000).contains(&at), "{at:#x}");
}
