//! What the header of a capture says: each field that WIRE.md lists, and no other; which clock it was.

use std::collections::BTreeSet;

use inm_protocol::image::BOARD;
use inm_protocol::{Identity, Restart, SensorCalibration, SensorRange, Settings};
use serde_json::Value;

use super::{ClockSource, Header, RegistersOf};

const WIRE: &str = include_str!("../../../protocol/WIRE.md");

fn identity(restart: Restart) -> Identity {
    Identity {
        serial: [1, 2, 3],
        firmware: "0.1.0".try_into().expect("short"),
        platform: BOARD.try_into().expect("short"),
        timer_hz: 1_000_000,
        converter_clock_hz: 4_096_000,
        baud: 921_600,
        range: SensorRange::G4,
        reference_uv: 5_000_000,
        sensor_supply_uv: 2_800_000,
        converters: [Some(0x10); 3],
        settings: Settings::default(),
        restart,
    }
}

fn header(identity: &Identity) -> Header {
    let registers = ([[0; 11]; 3], RegistersOf::Record);
    Header::new(identity, registers, "2026-11-23T00:00:00Z".into())
}

/// The fields below a value, each with its path.
fn fields(path: &str, value: &Value, found: &mut BTreeSet<String>) {
    match value {
        // What an enumeration holds is a table of its own.
        Value::Object(inner) if !path.ends_with("filter") => {
            let dot = if path.is_empty() { "" } else { "." };
            for (name, value) in inner {
                fields(&format!("{path}{dot}{name}"), value, found);
            }
        }
        Value::Array(inner) if inner.iter().all(Value::is_object) => {
            fields(&format!("{path}[]"), &inner[0], found);
        }
        _ => {
            found.insert(path.to_owned());
        }
    }
}

/// What is kept is used as it is, for its own range and for words that no converter corrects.
#[test]
fn axes_are_by_the_calibration_that_is_kept_where_it_fits() {
    let kept = SensorCalibration {
        range: SensorRange::G4,
        gravity_um_s2: 9_810_000,
        rows: [370_000_000, -5, 380_000_000, 6, 7, 390_000_000],
        zero: [1000, -2000, 3000],
        ..SensorCalibration::default()
    };
    let with = |registers: [u8; 11], kept| {
        let registers = ([registers; 3], RegistersOf::Record);
        Header::new(&identity(Restart::Power), registers, String::new()).calibrated(Some(kept))
    };
    let mut registers = [0; 11];
    registers[10] = 0x40;
    let sheets = with(
        registers,
        SensorCalibration {
            range: SensorRange::G12,
            ..kept
        },
    );
    assert_eq!(sheets.calibration, None);
    let used = with(registers, kept);
    assert_eq!(used.calibration, Some(kept));
    for (axis, (row, zero)) in [(370e6, 1000.0), (380e6, -2000.0), (390e6, 3000.0)]
        .into_iter()
        .enumerate()
    {
        assert_eq!(used.axes[axis].scale, row * 1e-16, "axis {axis}");
        assert_eq!(used.axes[axis].zero, zero, "axis {axis}");
        // Within a tenth of the sheets, or the unit is wrong.
        let off = used.axes[axis].scale / sheets.axes[axis].scale - 1.0;
        assert!(off.abs() < 0.1, "axis {axis}: {off}");
    }
    let unsound = with(
        registers,
        SensorCalibration {
            rows: [0; 6],
            ..kept
        },
    );
    assert_eq!(unsound.axes, sheets.axes);
    registers[5] = 1;
    assert_eq!(with(registers, kept).axes, sheets.axes);
}

#[test]
fn every_field_of_the_header_is_documented_and_no_other() {
    let mut written = BTreeSet::new();
    let value = serde_json::to_value(header(&identity(Restart::Power))).expect("a header is JSON");
    fields("", &value, &mut written);
    assert!(written.contains("axes[].scale"), "{written:?}");
    let section = WIRE.split("\n## Capture\n").nth(1).expect("a section");
    let section = section.split("\n## ").next().unwrap_or_default();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `"));
    let documented: BTreeSet<String> = rows
        .filter_map(|row| row.split_once('`'))
        .map(|(name, _)| name.to_owned())
        .collect();
    assert_eq!(documented, written);
}

/// Whatever the restart was: a board on its internal oscillator is not taken for one on its crystal.
#[test]
fn a_clock_that_did_not_start_is_said_whatever_the_restart_was() {
    let file = b"main.rs".iter().copied().collect();
    for restart in [
        Restart::Power,
        Restart::Command,
        Restart::Watchdog,
        Restart::Panic { line: 7, file },
    ] {
        let clock = |restart| header(&identity(restart)).board.clock;
        assert_eq!(clock(restart.clone()), ClockSource::Crystal);
        assert_eq!(
            clock(restart.on_internal_oscillator()),
            ClockSource::Internal
        );
    }
}
