//! A NumPy array, as a stream and as a file, read with options that the first byte chooses.

use std::io::{Cursor, Write};

use inm_host::SourceError;
use inm_host::internals::source::Source;
use inm_host::internals::source::open::stream;

use super::options::chosen;
use super::whole;

/// What every array file begins with; without it a file is read as text, which has its own promise.
const MAGIC: &[u8] = b"\x93NUMPY";

/// The bit of the choice by which it is read as a file, which is what column after column needs.
const AS_FILE: u8 = 0x80;

/// Reads as `inm analyze` does.
pub fn keeps(bytes: &[u8]) {
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    let options = chosen(choice);
    let array = [MAGIC, rest].concat();
    // An element has a byte or more, and a row an element.
    let most = rest.len();
    let check = |opened: Result<Box<dyn Source>, SourceError>| match opened {
        Ok(mut source) => whole::read(&mut *source, most),
        Err(error) => assert!(!error.to_string().is_empty()),
    };
    if choice & AS_FILE == 0 {
        return check(stream("fuzz.npy", Box::new(Cursor::new(array)), &options));
    }
    let mut file = tempfile::NamedTempFile::new().expect("a file");
    file.write_all(&array).expect("written");
    let path = file.path().to_str().expect("a name in ASCII");
    check(inm_host::open(path, &options));
}
