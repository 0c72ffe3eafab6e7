//! `inm flash` without a board: the image is checked, a missing probe is a clear message.
#![cfg(feature = "flash")]

#[path = "image/mod.rs"]
mod image;

use std::path::PathBuf;
use std::process::{Command, Output};

use image::{ARM, Parts, elf, elf_of, header, program};
use inm_protocol::image::{BOARD, QEMU, mark};
use inm_protocol::slot::{FLASH, HEADER, SLOT_STARTS};

/// An image for `platform`.
fn whole(platform: &str) -> Parts {
    image::image(platform, "1.2.3", 20)
}

/// An image whose program of slot 0 is changed so, with a header that fits.
fn changed(change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut parts = whole(BOARD);
    change(&mut parts[2].1);
    parts[1].1 = header(&parts[2].1, 1);
    elf(&parts)
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
    let parts = whole(BOARD);
    let bytes: usize = parts.iter().map(|(_, bytes)| bytes.len()).sum();
    let (output, stderr, _folder) = flash(&elf(&parts), &["--dry-run"]);
    assert!(output.status.success(), "{stderr}");
    let stdout = String::from_utf8_lossy(&output.stdout);
    let told = format!("firmware 1.2.3 of revision 0123456789ab, {bytes} bytes in 5 segments");
    assert!(stdout.contains(&told), "{stdout}");
}

#[test]
fn without_a_probe_the_message_says_what_to_plug_in() {
    // A name that no probe has, so that the test holds on a bench with a probe, too.
    let (output, stderr, _folder) = flash(&elf(&whole(BOARD)), &["--probe", "no such probe"]);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(
        stderr.contains("no debug probe `no such probe`"),
        "{stderr}"
    );
}

#[test]
fn what_is_no_image_for_the_board_is_refused() {
    let parts = whole(BOARD);
    let borrowed: Vec<_> = parts.iter().map(|(at, bytes)| (*at, &bytes[..])).collect();
    let sound = elf(&parts);
    assert_refused(b"#!/bin/sh\n", "not a 32-bit ELF file");
    assert_refused(&elf_of(62, &borrowed), "built for ELF machine 62");
    assert_refused(
        &elf_of(ARM, &[(FLASH, &[])]),
        "no vector table at 0x08000000",
    );
    assert_refused(&sound[..300], "the file ends at byte 300");
}

/// One part of it is missing, or is not what the others are.
#[test]
fn an_image_that_is_not_whole_is_refused() {
    let without = |part: usize| {
        let mut parts = whole(BOARD);
        parts.remove(part);
        elf(&parts)
    };
    assert_refused(&without(0), "no vector table at 0x08000000");
    for (part, slot) in [(1, 0), (2, 0), (3, 1), (4, 1)] {
        let expected = format!("no program for slot {slot}, at {:#010x}", SLOT_STARTS[slot]);
        assert_refused(&without(part), &expected);
    }
    // As it was before there was a loader.
    let old = vec![(FLASH, program(BOARD, "1.2.3", FLASH, 100))];
    assert_refused(&elf(&old), "of a release before the loader");
    let mut mixed = whole(BOARD);
    mixed[3..].clone_from_slice(&image::image(BOARD, "1.2.4", 20)[3..]);
    assert_refused(
        &elf(&mixed),
        "firmware 1.2.3 of 0123456789ab and firmware 1.2.4",
    );
}

/// Each of them was called sound.
#[test]
fn an_image_that_lies_outside_of_the_flash_is_refused() {
    for (address, expected) in [
        (
            0x1fff_7800,
            "one-time programmable area, which can never be erased",
        ),
        (
            0x1fff_c000,
            "option bytes, which can lock the chip for ever",
        ),
        (0x1fff_0000, "the chip's own loader"),
        (0x2000_0000, "the RAM, which is lost"),
        (0x1000_0000, "the core-coupled RAM"),
        (0x0810_0000, "beyond the end of the flash"),
        (0x080f_fff0, "the board keeps its calibration"),
        (0x080c_0000, "the board keeps its calibration"),
        (0x080a_0000, "behind the programs, which is kept free"),
        (0x0809_fff8, "behind the programs, which is kept free"),
        (0x0800_4000, "between the loader and the programs"),
        (0x0800_3ff8, "between the loader and the programs"),
        (0x0805_fff8, "the place of another part of the image"),
        (0, "below the flash"),
        (0x4000_0000, "no memory of the chip"),
        (0xffff_fff8, "no memory of the chip"),
    ] {
        let bytes = vec![0x55; 16];
        let mut parts = whole(BOARD);
        parts.push((address, bytes.clone()));
        let file = elf(&parts);
        assert_refused(&file, expected);
        assert_refused(&file, &format!("16 bytes at {address:#010x}"));
        // Alone as well, where it was a missing vector table at most.
        assert_refused(&elf(&vec![(address, bytes)]), expected);
    }
}

#[test]
fn segments_that_overlap_are_refused() {
    let mut parts = whole(BOARD);
    let last = FLASH + parts[0].1.len() as u32 - 1;
    parts.push((last, vec![0x55; 16]));
    assert_refused(&elf(&parts), &format!("overlap at {last:#010x}"));
}

/// A file of 3 MB whose 65 000 segments are all the same bytes took as many copies of them.
#[test]
fn segments_that_share_their_bytes_cost_no_memory() {
    let (segments, len) = (65_000_u16, 256 * 1024);
    let table = 52 + 32 * u32::from(segments);
    let mut file = elf_of(ARM, &[(FLASH, &[])]);
    file[44..46].copy_from_slice(&segments.to_le_bytes());
    file.truncate(52);
    let start = SLOT_STARTS[0];
    for _ in 0..segments {
        for word in [1, table, start, start, len, len, 5, 4] {
            file.extend(word.to_le_bytes());
        }
    }
    file.resize((table + len) as usize, 0x55);
    assert_refused(&file, "overlap at 0x08020000");
}

#[test]
fn vectors_that_start_nothing_are_refused() {
    let start = SLOT_STARTS[0] + HEADER;
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
        (4, start + 8, "the reset vector is 0x08020208"),
        (4, start + 0x1001, "the reset vector is 0x08021201"),
        // That of the other slot, of the loader.
        (
            4,
            SLOT_STARTS[1] + HEADER + 9,
            "the reset vector is 0x08060209",
        ),
        (4, FLASH + 9, "the reset vector is 0x08000009"),
    ] {
        let file = changed(|program| program[at..at + 4].copy_from_slice(&word.to_le_bytes()));
        assert_refused(&file, expected);
    }
}

#[test]
fn an_image_of_another_program_or_machine_is_refused() {
    assert_refused(&elf(&whole(QEMU)), "the image is for `qemu`");
    let foreign = changed(|program| program.truncate(48));
    assert_refused(&foreign, "no mark of this project");
    // As the linker leaves it, before `cargo xtask firmware` has filled in the rest.
    let linked = changed(|program| {
        program.truncate(48);
        program.extend(mark(BOARD, "1.2.3"));
    });
    assert_refused(&linked, "no revision and no checksum");
}

/// A bit of any part.
#[test]
fn a_damaged_image_is_refused() {
    for (part, expected) in [
        (0, "the file is damaged"),
        (1, "no program for slot 0"),
        (2, "the file is damaged"),
        (3, "no program for slot 1"),
        (4, "the file is damaged"),
    ] {
        let mut parts = whole(BOARD);
        *parts[part].1.last_mut().expect("bytes") ^= 1;
        assert_refused(&elf(&parts), expected);
    }
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
