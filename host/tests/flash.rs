//! `inm flash` without a board: the image is checked, a missing probe is a clear message.
#![cfg(feature = "flash")]

use std::path::PathBuf;
use std::process::{Command, Output};

use inm_protocol::image::{BOARD, MARK_LEN, QEMU, checksum, mark, set_checksum, set_revision};

/// `e_machine` of Arm.
const ARM: u16 = 40;

/// Where the flash begins.
const FLASH: u32 = 0x0800_0000;

/// A 32-bit little-endian ELF file with loadable segments at these addresses.
fn elf_of(machine: u16, segments: &[(u32, &[u8])]) -> Vec<u8> {
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

fn elf(machine: u16, address: u32, bytes: &[u8]) -> Vec<u8> {
    elf_of(machine, &[(address, bytes)])
}

/// A program for `platform`: vectors, its mark, and more, with its checksum.
fn program(platform: &str) -> Vec<u8> {
    let mut mark = mark(platform, "1.2.3");
    set_revision(&mut mark, "0123456789ab");
    let with = |mark: &[u8; MARK_LEN]| {
        let stack = 0x2000_8000_u32.to_le_bytes();
        let reset = (FLASH + 8 + 1).to_le_bytes();
        [&stack[..], &reset, &[0x55; 40], mark, &[0x66; 20]].concat()
    };
    let blank = with(&mark);
    set_checksum(&mut mark, checksum([(FLASH.into(), &blank[..])]));
    with(&mark)
}

fn flash(contents: &[u8], options: &[&str]) -> (Output, String, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path: PathBuf = folder.path().join("image.elf");
    std::fs::write(&path, contents).expect("writable");
    let output = Command::new(env!("CARGO_BIN_EXE_inm"))
        .arg("flash")
        .arg(&path)
        .args(options)
        .output()
        .expect("inm runs");
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    (output, stderr, folder)
}

fn assert_refused(contents: &[u8], expected: &str) {
    let (output, stderr, _folder) = flash(contents, &["--dry-run"]);
    assert_eq!(output.status.code(), Some(2), "`{expected}`: {stderr}");
    assert!(
        stderr.contains(expected),
        "`{expected}` is not in: {stderr}"
    );
    assert!(stderr.contains("image.elf"), "{stderr}");
}

#[test]
fn a_sound_image_passes_the_dry_run_and_is_told() {
    let image = program(BOARD);
    let (output, stderr, _folder) = flash(&elf(ARM, FLASH, &image), &["--dry-run"]);
    assert!(output.status.success(), "{stderr}");
    let stdout = String::from_utf8_lossy(&output.stdout);
    let told = format!(
        "firmware 1.2.3 of revision 0123456789ab, {} bytes in 1 segments",
        image.len()
    );
    assert!(stdout.contains(&told), "{stdout}");
}

#[test]
fn without_a_probe_the_message_says_what_to_plug_in() {
    let image = elf(ARM, FLASH, &program(BOARD));
    // A name that no probe has, so that the test holds on a bench with a probe, too.
    let (output, stderr, _folder) = flash(&image, &["--probe", "no such probe"]);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(
        stderr.contains("no debug probe `no such probe`"),
        "{stderr}"
    );
}

#[test]
fn what_is_no_image_for_the_board_is_refused() {
    let x86 = elf(62, FLASH, &program(BOARD));
    let empty = elf(ARM, FLASH, &[]);
    let whole = elf(ARM, FLASH, &program(BOARD));
    assert_refused(b"#!/bin/sh\n", "not a 32-bit ELF file");
    assert_refused(&x86, "built for ELF machine 62");
    assert_refused(&empty, "no vector table at 0x08000000");
    assert_refused(&whole[..100], "the file ends at byte 100");
}

/// Each of them was called sound.
#[test]
fn an_image_that_lies_outside_of_the_flash_is_refused() {
    for (address, len, expected) in [
        (
            0x1fff_7800,
            16,
            "one-time programmable area, which can never be erased",
        ),
        (
            0x1fff_c000,
            16,
            "option bytes, which can lock the chip for ever",
        ),
        (0x1fff_0000, 16, "the chip's own loader"),
        (0x2000_0000, 16, "the RAM, which is lost"),
        (0x1000_0000, 16, "the core-coupled RAM"),
        (0x0810_0000, 16, "beyond the end of the flash"),
        (0x080f_fff0, 16, "the board keeps its calibration"),
        (0x080b_fff8, 16, "the board keeps its calibration"),
        (0, 16, "below the flash"),
        (0x4000_0000, 16, "no memory of the chip"),
        (0xffff_fff8, 16, "no memory of the chip"),
    ] {
        let bytes = vec![0x55; len];
        let others = [(address, &bytes[..])];
        let image = program(BOARD);
        let file = elf_of(ARM, &[(FLASH, &image), others[0]]);
        assert_refused(&file, expected);
        assert_refused(&file, &format!("16 bytes at {address:#010x}"));
        // Alone as well, where it was a missing vector table at most.
        assert_refused(&elf(ARM, address, &bytes), expected);
    }
}

#[test]
fn segments_that_overlap_are_refused() {
    let bytes = [0x55; 16];
    let image = program(BOARD);
    let last = FLASH + image.len() as u32 - 1;
    assert_refused(
        &elf_of(ARM, &[(FLASH, &image), (last, &bytes)]),
        &format!("overlap at {last:#010x}"),
    );
}

/// A file of 3 MB whose 65 000 segments are all the same bytes took as many copies of them.
#[test]
fn segments_that_share_their_bytes_cost_no_memory() {
    let (segments, len) = (65_000_u16, 768 * 1024);
    let table = 52 + 32 * u32::from(segments);
    let mut file = elf(ARM, FLASH, &[]);
    file[44..46].copy_from_slice(&segments.to_le_bytes());
    file.truncate(52);
    for _ in 0..segments {
        for word in [1, table, FLASH, FLASH, len, len, 5, 4] {
            file.extend(word.to_le_bytes());
        }
    }
    file.resize((table + len) as usize, 0x55);
    assert_refused(&file, "overlap at 0x08000000");
}

#[test]
fn vectors_that_start_nothing_are_refused() {
    let image = program(BOARD);
    for (at, word, expected) in [
        (
            0,
            0xffff_ffff_u32,
            "the initial stack pointer is 0xffffffff",
        ),
        (0, 0, "the initial stack pointer is 0x00000000"),
        (0, 0x2002_0004, "the initial stack pointer is 0x20020004"),
        (4, 0xffff_ffff, "the reset vector is 0xffffffff"),
        (4, 0, "the reset vector is 0x00000000"),
        (4, FLASH + 8, "the reset vector is 0x08000008"),
        (4, FLASH + 0x1001, "the reset vector is 0x08001001"),
    ] {
        let mut blank = image.clone();
        blank[at..at + 4].copy_from_slice(&word.to_le_bytes());
        assert_refused(&elf(ARM, FLASH, &blank), expected);
    }
}

#[test]
fn an_image_of_another_program_or_machine_is_refused() {
    let qemu = program(QEMU);
    assert_refused(&elf(ARM, FLASH, &qemu), "the image is for `qemu`");
    let mut foreign = program(BOARD);
    foreign.truncate(48);
    assert_refused(&elf(ARM, FLASH, &foreign), "no mark of this project");
    // As the linker leaves it, before `cargo xtask firmware` has filled in the rest.
    let linked = [&foreign[..], &mark(BOARD, "1.2.3")].concat();
    assert_refused(&elf(ARM, FLASH, &linked), "no revision and no checksum");
    let mut damaged = program(BOARD);
    *damaged.last_mut().expect("bytes") ^= 1;
    assert_refused(&elf(ARM, FLASH, &damaged), "the file is damaged");
}

#[test]
fn a_missing_image_is_named() {
    let output = Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(["flash", "no-such-image.elf"])
        .output()
        .expect("inm runs");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("no-such-image.elf"), "{stderr}");
}
