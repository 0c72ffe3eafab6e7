//! Decides by its content what kind of source a file is, and opens it.

use std::cell::Cell;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::array::ArraySource;
use super::capture::CaptureSource;
use super::excluding::Excluding;
use super::npy::{MAGIC, NpyTable};
use super::options::ArrayOptions;
use super::part::Part;
use super::table::Table;
use super::text::TextTable;
use super::{Source, SourceError};

/// Stands for standard input in place of a file name.
pub const STANDARD_INPUT: &str = "-";

/// Bytes that are looked at to distinguish text from anything else.
const SNIFFED: u64 = 512;

/// What every capture begins with, of whatever version.
pub const CAPTURE_START: &[u8] = b"#inm-capture";

/// Opens a capture or an array file, or standard input where `path` is `-`.
///
/// What it is shows in its first bytes, not in its name.
///
/// # Errors
/// If it cannot be opened, is empty, is of an unknown kind, or does not go together with
/// the options.
pub fn open(path: &str, options: &ArrayOptions) -> Result<Box<dyn Source>, SourceError> {
    let source = whole(path, options)?;
    Ok(if options.exclude_s.is_empty() {
        source
    } else {
        Box::new(Excluding::new(source, &options.exclude_s))
    })
}

/// All of it, but for what `--from` and `--to` cut off.
fn whole(path: &str, options: &ArrayOptions) -> Result<Box<dyn Source>, SourceError> {
    if path == STANDARD_INPUT {
        return stream(
            "standard input",
            Box::new(BufReader::new(std::io::stdin())),
            options,
        );
    }
    let io = |error: std::io::Error| SourceError {
        place: path.to_owned(),
        message: format!("cannot be read: {error}"),
        remedy: match error.kind() {
            std::io::ErrorKind::NotFound => "check the name and the folder".into(),
            _ => String::new(),
        },
    };
    let mut file = File::open(path).map_err(io)?;
    let mut start = Vec::new();
    Read::by_ref(&mut file)
        .take(SNIFFED)
        .read_to_end(&mut start)
        .map_err(io)?;
    if start.starts_with(CAPTURE_START) {
        let source = CaptureSource::open(Path::new(path))?;
        return capture(path, source, options);
    }
    if start.starts_with(MAGIC) {
        let table = || Ok(Box::new(NpyTable::open(Path::new(path), path)?) as Box<dyn Table>);
        return Ok(Box::new(ArraySource::new(&table, options)?));
    }
    check_text(path, &start)?;
    let table = || {
        let reader = Box::new(BufReader::new(File::open(path).map_err(io)?));
        text(path, reader, options)
    };
    Ok(Box::new(ArraySource::new(&table, options)?))
}

/// A capture, which says itself what an array file does not.
fn capture(
    path: &str,
    source: CaptureSource,
    options: &ArrayOptions,
) -> Result<Box<dyn Source>, SourceError> {
    let ArrayOptions {
        rate_hz,
        time,
        decimal,
        columns,
        unit,
        scales,
        from_s,
        to_s,
        chain,
        exclude_s: _,
    } = options;
    let told = [
        ("--rate", rate_hz.is_some()),
        ("--time", time.is_some()),
        ("--decimal", decimal.is_some()),
        ("--unit", unit.is_some()),
        ("--scale", !scales.is_empty()),
        ("--chain", chain.is_some()),
    ];
    if let Some((option, _)) = told.iter().find(|(_, given)| *given) {
        return Err(SourceError {
            place: path.to_owned(),
            message: format!(
                "a capture carries its own rate, scale, unit and chain; {option} \
                              cannot change them"
            ),
            remedy: format!("leave out {option}"),
        });
    }
    Ok(Box::new(Part::new(source, columns, *from_s, *to_s)?))
}

/// A stream is read once, so the place of its rows must not depend on the last of them: with stamps it
/// is a file first.
///
/// # Errors
/// As [`open`].
pub fn stream(
    name: &str,
    mut reader: Box<dyn BufRead>,
    options: &ArrayOptions,
) -> Result<Box<dyn Source>, SourceError> {
    let io = |error: std::io::Error| SourceError {
        place: name.to_owned(),
        message: format!("cannot be read: {error}"),
        remedy: String::new(),
    };
    let start = reader.fill_buf().map_err(io)?.to_vec();
    if start.starts_with(CAPTURE_START) {
        let source = CaptureSource::read(reader, Path::new(name))?;
        return capture(name, source, options);
    }
    let is_npy = start.starts_with(MAGIC);
    if !is_npy {
        check_text(name, &start)?;
    }
    if options.time.is_some() {
        let mut spool = tempfile::NamedTempFile::new().map_err(io)?;
        std::io::copy(&mut reader, &mut spool).map_err(io)?;
        let table = || {
            if is_npy {
                return Ok(Box::new(NpyTable::open(spool.path(), name)?) as Box<dyn Table>);
            }
            let reader = Box::new(BufReader::new(spool.reopen().map_err(io)?));
            text(name, reader, options)
        };
        return Ok(Box::new(ArraySource::new(&table, options)?));
    }
    let reader = Cell::new(Some(reader));
    let table = || match reader.take() {
        Some(reader) if is_npy => Ok(Box::new(NpyTable::stream(name, reader)?) as Box<dyn Table>),
        Some(reader) => text(name, reader, options),
        None => Err(io(std::io::ErrorKind::UnexpectedEof.into())),
    };
    Ok(Box::new(ArraySource::new(&table, options)?))
}

/// Refuses what is neither a NumPy array nor text, by its `start`.
fn check_text(name: &str, start: &[u8]) -> Result<(), SourceError> {
    let bad = |message: &str, remedy: &str| SourceError {
        place: name.to_owned(),
        message: message.to_owned(),
        remedy: remedy.to_owned(),
    };
    if start.is_empty() {
        return Err(bad("the file is empty", "record or copy it again"));
    }
    if start.contains(&0) {
        return Err(bad(
            "byte 0: neither a NumPy array nor text",
            "array files are .npy, .csv or columns of text",
        ));
    }
    Ok(())
}

fn text(
    name: &str,
    reader: Box<dyn BufRead>,
    options: &ArrayOptions,
) -> Result<Box<dyn Table>, SourceError> {
    Ok(Box::new(TextTable::open(name, reader, options.decimal)?))
}
