//! Decides by its content what kind of source a file is, and opens it.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::array::ArraySource;
use super::capture::CaptureSource;
use super::excluding::Excluding;
use super::npy::NpyTable;
use super::npy_header::MAGIC;
use super::options::ArrayOptions;
use super::part::Part;
use super::text::TextTable;
use super::{Source, SourceError};

/// Stands for standard input in place of a file name.
pub const STANDARD_INPUT: &str = "-";

/// Bytes that are looked at to distinguish text from anything else.
const SNIFFED: u64 = 512;

/// What every capture begins with, of whatever version.
const CAPTURE_START: &[u8] = b"#inm-capture";

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
        return capture(path, options);
    }
    if start.starts_with(MAGIC) {
        let table = NpyTable::open(Path::new(path))?;
        return Ok(Box::new(ArraySource::new(Box::new(table), options)?));
    }
    text(
        path,
        &start,
        Box::new(BufReader::new(File::open(path).map_err(io)?)),
        options,
    )
}

/// A capture, which says itself what an array file does not.
fn capture(path: &str, options: &ArrayOptions) -> Result<Box<dyn Source>, SourceError> {
    let ArrayOptions {
        rate_hz,
        time,
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
    let source = CaptureSource::open(Path::new(path))?;
    Ok(Box::new(Part::new(source, columns, *from_s, *to_s)?))
}

fn stream(
    name: &str,
    mut reader: Box<dyn BufRead>,
    options: &ArrayOptions,
) -> Result<Box<dyn Source>, SourceError> {
    let start = reader
        .fill_buf()
        .map_err(|error| SourceError {
            place: name.to_owned(),
            message: format!("cannot be read: {error}"),
            remedy: String::new(),
        })?
        .to_vec();
    if start.starts_with(MAGIC) {
        let table = NpyTable::stream(name, Box::new(reader))?;
        return Ok(Box::new(ArraySource::new(Box::new(table), options)?));
    }
    text(name, &start, reader, options)
}

fn text(
    name: &str,
    start: &[u8],
    reader: Box<dyn BufRead>,
    options: &ArrayOptions,
) -> Result<Box<dyn Source>, SourceError> {
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
    let table = TextTable::open(name, reader)?;
    Ok(Box::new(ArraySource::new(Box::new(table), options)?))
}
