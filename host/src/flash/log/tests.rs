//! Frames as a board sends them, by the table of the image that comes with this program.

use std::path::Path;

use rand_distr::{Distribution, Uniform};

use super::*;
use crate::flash::shipped;
use crate::model::Seed;
use crate::model::random::random;

fn table() -> LogTable {
    LogTable::parse(shipped::BOARD, Path::new("shipped")).expect("a log table")
}

/// A frame in rzCOBS, by the book: seven bytes a code, and no run is compressed.
fn encoded(bytes: &[u8]) -> Vec<u8> {
    let mut padded = bytes.to_vec();
    // Zeros behind the end of a frame are none of its arguments.
    padded.resize(bytes.len().div_ceil(7) * 7, 0);
    let mut frame = Vec::new();
    for group in padded.chunks(7) {
        let mut code = 0;
        for (place, &byte) in group.iter().enumerate() {
            if byte == 0 {
                code |= 1 << place;
            } else {
                frame.push(byte);
            }
        }
        // All seven without a zero: a run of that length, whose code holds a zero that it does not have.
        assert_ne!(code, 0, "seven bytes without a zero: {group:?}");
        frame.push(code);
    }
    frame.push(0);
    frame
}

/// A frame of the line whose text contains `text`, at a time, with arguments.
fn frame(table: &LogTable, text: &str, up_us: u64, arguments: &[u8]) -> Vec<u8> {
    let number = table.find(text).expect("a line of the firmware");
    let mut bytes = number.to_le_bytes().to_vec();
    bytes.extend(up_us.to_le_bytes());
    bytes.extend(arguments);
    encoded(&bytes)
}

fn trouble(table: &LogTable, variant: u8, fields: &[u8]) -> Vec<u8> {
    let kind = table
        .find("Stalled|Stuck")
        .expect("the protocol's troubles");
    let mut arguments = 1_u32.to_le_bytes().to_vec();
    arguments.push(b'Y');
    arguments.extend(70_000_u64.to_le_bytes());
    arguments.extend(kind.to_le_bytes());
    arguments.push(variant);
    arguments.extend(fields);
    frame(table, "conversion {=u64}: {}", 2_500_000, &arguments)
}

#[test]
fn a_trouble_is_told_with_the_boards_time_and_in_words() {
    let table = table();
    let mut decoder = table.decoder();
    let bytes = [
        frame(&table, "restart by command", 1_234_567, &[]),
        trouble(&table, 1, &[1]),
        frame(&table, "hard fault", 3, &0x0800_0123_u32.to_le_bytes()),
    ]
    .concat();
    // In pieces of any size.
    let lines: Vec<Line> = bytes
        .chunks(3)
        .flat_map(|piece| decoder.take(piece))
        .collect();
    let told: Vec<_> = lines
        .iter()
        .map(|line| (line.level, line.what.as_str()))
        .collect();
    assert_eq!(
        told,
        [
            (Some("info"), "restart by command"),
            (Some("warn"), "Y, conversion 70000: Stuck { ones: true }"),
            (Some("error"), "hard fault at 08000123"),
        ]
    );
    let up_s = lines.iter().filter_map(|line| line.up_s);
    let off = up_s
        .zip([1.234_567, 2.5, 3e-6])
        .map(|(one, other)| (one - other).abs());
    assert!(off.fold(0.0, f64::max) < 1e-9, "{lines:?}");
    assert_eq!(lines[1].from.as_deref(), Some("inm_firmware"));
}

#[test]
fn frames_that_cannot_be_read_are_counted_once_one_can() {
    let table = table();
    let whole = frame(&table, "restart by command", 1, &[]);
    let mut decoder = table.decoder();
    // Cut at its beginning, and one of a line that no image has.
    let unknown = encoded(&[0xf0, 0xf0, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(decoder.take(&[&whole[3..], &unknown].concat()), []);
    let lines = decoder.take(&whole);
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(
        lines[0]
            .what
            .starts_with("2 frames of the log cannot be read"),
        "{lines:?}"
    );
}

#[test]
fn what_has_no_log_is_refused_with_what_to_take() {
    let refused = LogTable::parse(b"no image", Path::new("x.elf")).expect_err("no ELF file");
    assert!(
        refused
            .to_string()
            .contains("x.elf: the image has no log table"),
        "{refused}"
    );
    // Of another version: the number behind the equals sign.
    let mut other = shipped::BOARD.to_vec();
    let name = b"_defmt_version_ = 4";
    let at = other
        .windows(name.len())
        .position(|place| place == name)
        .expect("its version");
    other[at + name.len() - 1] = b'9';
    let refused = LogTable::parse(&other, Path::new("y.elf")).expect_err("another version");
    assert!(
        refused
            .to_string()
            .contains("y.elf: the image's log is not of"),
        "{refused}"
    );
}

/// Whatever comes, from a board that is none of ours or a line that is damaged.
#[test]
fn any_bytes_are_borne() {
    let table = table();
    let byte = Uniform::new_inclusive(0_u8, 255).expect("a range");
    for seed in 0..2000 {
        let mut random = random(Seed { seed, stream: 6 });
        let length = 3 * usize::from(byte.sample(&mut random));
        let bytes: Vec<u8> = (0..length).map(|_| byte.sample(&mut random) % 32).collect();
        let _ = table.decoder().take(&bytes);
    }
}
