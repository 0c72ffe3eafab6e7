//! Writes the seeds of `cargo xtask fuzz` into `fuzz/corpus`: a few small files a target, from what the
//! tests have. Run it again when a format changes: `cargo run -p inm-tests --example fuzz_seeds`.

use std::fs;
use std::path::Path;

use inm_allan::Bins;
use inm_protocol::crc32;
use inm_protocol::image::{BOARD, checksum, mark, set_checksum, set_revision};
use inm_protocol::slot::{FLASH, HEADER, Header, SLOT_STARTS};
use inm_tests::golden;

/// Frames of each kind of message that are kept: the shortest, which say as much as any.
const FRAMES_A_KIND: usize = 2;

/// Levels of the states, as in `allan/tests/any_state`.
const LEVELS: usize = 4;

/// The byte that chooses: by the rate, unit given, the names of the columns asked as well.
const BY_RATE: u8 = 0x30;
/// The same with the time in column 0.
const BY_TIME: u8 = 0x31;
const BY_MICROSECONDS: u8 = 0x22;
const WITH_COMMAS: u8 = 0x24;
/// An array as a file.
const AS_FILE: u8 = 0x80;

fn main() {
    // Of each version of the protocol.
    for (file, version) in [("board.inmcap", ""), ("board-2.inmcap", "-2")] {
        let capture = fs::read(golden::path(file)).expect("a capture");
        let mut lines = capture.splitn(3, |&byte| byte == b'\n');
        let header = lines.nth(1).expect("a header");
        let stream = lines.next().expect("frames");
        write("header", &format!("recorded{version}"), header);
        frames(stream, version);
    }
    text();
    npy();
    for name in ["model", "cyclic.model", "unnamed.model", "diagnosis.model"] {
        let model = fs::read(golden::path(&format!("{name}.json")));
        write("model", name, &model.expect("a model"));
    }
    write("elf", "program", &elf(&image()));
    write("elf", "blank", &elf(&[(FLASH, vec![0xff; 128])]));
    for (name, samples) in [("empty", 0), ("short", 3), ("long", 300)] {
        let mut bins = Bins::<LEVELS>::starting_at(0);
        bins.push_slice(&(0..samples).map(|k| k * k).collect::<Vec<_>>());
        bins.skip(1);
        let state = postcard::to_stdvec(&bins).expect("a state");
        write("state", name, &state);
    }
}

fn write(target: &str, name: &str, bytes: &[u8]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    let folder = root.join(target);
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join(name), bytes).expect("written");
}

/// The shortest frames of each kind, as they came, and as pieces with their lengths.
fn frames(stream: &[u8], version: &str) {
    let mut frames: Vec<&[u8]> = stream.split_inclusive(|&byte| byte == 0).collect();
    frames.sort_by_key(|frame| frame.len());
    let mut kept = std::collections::BTreeMap::<u8, usize>::new();
    let (mut as_is, mut pieces) = (vec![0], vec![1]);
    for frame in frames {
        let mut payload = frame[..frame.len().saturating_sub(1)].to_vec();
        let Ok(length) = cobs::decode_in_place(&mut payload) else {
            continue;
        };
        // Between the version, which stays, and the check sum.
        let Some(message) = payload.get(1..length.saturating_sub(4)) else {
            continue;
        };
        let count = kept.entry(message[0]).or_default();
        if *count == FRAMES_A_KIND {
            continue;
        }
        *count += 1;
        as_is.extend_from_slice(frame);
        pieces.extend((message.len() as u16).to_le_bytes());
        pieces.extend_from_slice(message);
    }
    for target in ["capture", "frames"] {
        write(target, &format!("as-it-came{version}"), &as_is);
        write(target, &format!("pieces{version}"), &pieces);
    }
}

fn text() {
    let log = |choice: u8, text: &str| [&[choice], text.as_bytes()].concat();
    for (name, choice, lines) in [
        ("commas", BY_RATE, "ax_g,ay_g\n1.5,2\n-3e-2,nan\n,4\n"),
        ("blanks", BY_RATE, "# made by hand\n 1.5  2\n 3.5 -4\n"),
        ("decimal", WITH_COMMAS, "x;y\n1,5;2,25\n3,5;4,125\n"),
        (
            "stamps",
            BY_TIME,
            "t [s],x\n0,1\n0.001,2\n0.002,3\n0.005,4\n0.006,5\n",
        ),
        (
            "micros",
            BY_MICROSECONDS,
            "micros\tx\n10\t1\n1010\t2\n2010\t3\n3010\t4\n",
        ),
        (
            "quoted",
            BY_RATE,
            "\"acc #1 (m/s^2)\",\"b\"\r\n\"1\",\"2\"\r\n3,4",
        ),
    ] {
        write("text", name, &log(choice, lines));
    }
}

fn npy() {
    let array = |choice: u8, descr: &str, fortran: &str, shape: &str, data: &[u8]| {
        let text =
            format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
        // The magic word is the target's.
        let mut bytes = vec![choice, 1, 0];
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend(data);
        bytes
    };
    let doubles: Vec<u8> = [0.0, 1.0, 0.001, f64::NAN, 0.002, -4.0]
        .into_iter()
        .flat_map(f64::to_le_bytes)
        .collect();
    for (name, bytes) in [
        ("rows", array(BY_RATE, "<f8", "False", "(3, 2)", &doubles)),
        (
            "stamped",
            array(BY_TIME, "<f8", "False", "(3, 2)", &doubles),
        ),
        (
            "columns",
            array(BY_RATE | AS_FILE, "<f8", "True", "(3, 2)", &doubles),
        ),
        (
            "shorts",
            array(BY_RATE, ">i2", "False", "(4,)", &doubles[..8]),
        ),
        (
            "wide",
            array(BY_RATE | AS_FILE, "<u8", "False", "(6,)", &doubles),
        ),
        (
            "halves",
            array(BY_RATE, "<f2", "False", "(4, 1)", &doubles[..8]),
        ),
    ] {
        write("npy", name, &bytes);
    }
}

/// A loader, and a program with its header for each slot.
fn image() -> Vec<(u32, Vec<u8>)> {
    let mut parts = vec![(FLASH, program(FLASH))];
    for (number, start) in (0..).zip(SLOT_STARTS) {
        let program = program(start + HEADER);
        let header = Header {
            number,
            length: program.len() as u32,
            crc: crc32(&program),
        };
        let words = header.words().into_iter().flat_map(u32::to_le_bytes);
        parts.push((start, words.collect()));
        parts.push((start + HEADER, program));
    }
    parts
}

/// Vectors, some code and the mark of a part of an image that lies at `address`.
fn program(address: u32) -> Vec<u8> {
    let mut mark = mark(BOARD, "1.2.3");
    set_revision(&mut mark, "0123456789ab");
    let with = |mark: &[u8]| {
        let stack = 0x2000_8000_u32.to_le_bytes();
        let reset = (address + 9).to_le_bytes();
        [&stack[..], &reset, &[0x55; 8], mark].concat()
    };
    let sum = checksum([(address.into(), &with(&mark)[..])]);
    set_checksum(&mut mark, sum);
    with(&mark)
}

/// A 32-bit little-endian ELF file for Arm with these segments.
fn elf(segments: &[(u32, Vec<u8>)]) -> Vec<u8> {
    let mut file = b"\x7fELF\x01\x01\x01".to_vec();
    file.resize(16, 0);
    for half in [2_u16, 40] {
        file.extend(half.to_le_bytes());
    }
    // Version, entry, program headers behind this header, no sections, no flags.
    for word in [1_u32, FLASH + 9, 52, 0, 0] {
        file.extend(word.to_le_bytes());
    }
    for half in [52_u16, 32, segments.len() as u16, 40, 0, 0] {
        file.extend(half.to_le_bytes());
    }
    let mut offset = 52 + 32 * segments.len() as u32;
    for (address, bytes) in segments {
        let length = bytes.len() as u32;
        for word in [1, offset, *address, *address, length, length, 5, 4] {
            file.extend(word.to_le_bytes());
        }
        offset += length;
    }
    for (_, bytes) in segments {
        file.extend_from_slice(bytes);
    }
    file
}
