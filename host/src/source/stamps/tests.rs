//! Stamps in every unit, said and not said.

use super::super::text::TextTable;
use super::*;

fn stamps(text: String, given: Option<TimeUnit>) -> Result<Stamps, SourceError> {
    let reader = Box::new(std::io::Cursor::new(text));
    let table = TextTable::open("t.csv", reader, None)?;
    read(Box::new(table), 0, given, &ArrayOptions::default())
}

fn log(name: &str, rows: u32, stamp: impl Fn(u32) -> f64) -> String {
    let rows = (0..rows).map(|row| format!("{},0.5\n", stamp(row)));
    format!("{name},x\n{}", rows.collect::<String>())
}

#[test]
fn a_unit_in_the_name_is_believed_and_said() {
    for (name, unit, rate_hz) in [
        ("millis", "ms", 100.0),
        ("t [ms]", "ms", 100.0),
        ("stamp_us", "us", 1e5),
        ("%time", "ns", 1e8),
    ] {
        let told = stamps(log(name, 100, |row| 10.0 * f64::from(row)), None);
        if POSSIBLE_HZ.contains(&rate_hz) {
            let told = told.expect("a believable rate");
            assert_eq!(told.rate_hz, rate_hz);
            let note = format!("column {name} is the time in {unit}, as its name says");
            assert_eq!(told.notes, [note]);
        } else {
            told.expect_err("a rate that cannot be meant");
        }
    }
}

#[test]
fn a_rate_that_cannot_be_meant_is_refused_with_what_would_do() {
    let milliseconds = || log("t", 100, |row| 10.0 * f64::from(row));
    let error = stamps(milliseconds(), None).expect_err("a tenth a second");
    let said = "t.csv: column t in s would mean 0.1 samples a second over 1000 s, which is hardly \
                meant; say the unit: --time t:ms (100/s), or --time t:s (0.1/s)";
    assert_eq!(error.to_string(), said);
    let told = stamps(milliseconds(), Some(TimeUnit::Milliseconds)).expect("said");
    assert_eq!((told.rate_hz, told.notes.len()), (100.0, 0));
    let told = stamps(milliseconds(), Some(TimeUnit::Seconds)).expect("said");
    assert_eq!(told.rate_hz, 0.1);
}

#[test]
fn a_rate_that_contradicts_the_stamps_is_refused() {
    let notes = &mut Vec::new();
    assert_eq!(agreed(100.0, Some(100.001), notes), Ok(100.001));
    assert!(notes.is_empty());
    assert_eq!(agreed(100.0, Some(101.0), notes), Ok(101.0));
    assert_eq!(notes, &["the time stamps give 100/s; taken is --rate 101"]);
    agreed(100.0, Some(2000.0), notes).expect_err("twenty times as fast");
}

#[test]
fn a_counter_that_wraps_goes_on() {
    let wrapping = log("micros", 100, |row| {
        (WRAP - 500_000.0 + 1e4 * f64::from(row)) % WRAP
    });
    let told = stamps(wrapping, None).expect("a wrap");
    assert_eq!((told.rate_hz, told.runs.len()), (100.0, 1));
    assert!(told.notes[0].contains("began again"), "{:?}", told.notes);
}
