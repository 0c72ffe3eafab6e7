//! `inm flash` without a board: the image is checked, a missing probe is a clear message.
#![cfg(feature = "flash")]

use std::path::PathBuf;
use std::process::{Command, Output};

/// `e_machine` of Arm.
const ARM: u16 = 40;

/// A 32-bit little-endian ELF file with one loadable segment.
fn elf(machine: u16, address: u32, bytes: &[u8]) -> Vec<u8> {
    let (header, program_header) = (52u32, 32u32);
    let offset = header + program_header;
    let mut file = b"\x7fELF\x01\x01\x01".to_vec();
    file.resize(16, 0);
    file.extend(2u16.to_le_bytes()); // executable
    file.extend(machine.to_le_bytes());
    file.extend(1u32.to_le_bytes());
    file.extend((address + 1).to_le_bytes()); // entry
    file.extend(header.to_le_bytes()); // program headers
    file.extend([0; 4]); // no section headers
    file.extend([0; 4]); // flags
    for half in [52u16, 32, 1, 40, 0, 0] {
        file.extend(half.to_le_bytes());
    }
    for word in [
        1,
        offset,
        address,
        address,
        bytes.len() as u32,
        bytes.len() as u32,
        5,
        4,
    ] {
        file.extend(word.to_le_bytes());
    }
    file.extend(bytes);
    file
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

#[test]
fn a_sound_image_passes_the_dry_run() {
    let (output, stderr, _folder) = flash(&elf(ARM, 0x0800_0000, &[0x55; 64]), &["--dry-run"]);
    assert!(output.status.success(), "{stderr}");
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(stdout.contains("64 bytes in 1 segments"), "{stdout}");
}

#[test]
fn without_a_probe_the_message_says_what_to_plug_in() {
    let image = elf(ARM, 0x0800_0000, &[0x55; 64]);
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
    let x86 = elf(62, 0x0800_0000, &[0x55; 64]);
    let elsewhere = elf(ARM, 0x2000_0000, &[0x55; 64]);
    let empty = elf(ARM, 0x0800_0000, &[]);
    let whole = elf(ARM, 0x0800_0000, &[0x55; 64]);
    let cases: [(&[u8], &str); 5] = [
        (b"#!/bin/sh\n", "not a 32-bit ELF file"),
        (&x86, "built for ELF machine 62"),
        (&elsewhere, "no vector table at 0x08000000"),
        (&empty, "no vector table at 0x08000000"),
        (&whole[..100], "the file ends at byte 100"),
    ];
    for (contents, expected) in cases {
        let (output, stderr, _folder) = flash(contents, &["--dry-run"]);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(
            stderr.contains(expected),
            "`{expected}` is not in: {stderr}"
        );
        assert!(stderr.contains("image.elf"), "{stderr}");
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
