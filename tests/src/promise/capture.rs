//! A capture whose header is sound, with any bytes behind it.

use std::io::Cursor;
use std::path::Path;

use inm_host::internals::source::capture::CaptureSource;

use super::pieces::stream;
use super::whole;

/// The header of a recording, both lines.
const HEADER: &[u8] = include_bytes!("header.txt");

/// Bytes of a conversion: three words.
const CONVERSION: usize = 12;

/// Reads as a replay does.
pub fn keeps(bytes: &[u8]) {
    let stream = stream(bytes);
    let most = stream.len() / CONVERSION;
    let input = Cursor::new([HEADER, &stream].concat());
    let source = CaptureSource::read(Box::new(input), Path::new("fuzz.inmcap"));
    whole::read(&mut source.expect("the header is sound"), most);
}
