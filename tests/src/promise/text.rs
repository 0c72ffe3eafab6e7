//! A log as text, read with options that the first byte chooses.

use std::io::Cursor;

use inm_host::internals::source::open::stream;

use super::options::chosen;
use super::whole;

/// Reads as `inm analyze -` does.
pub fn keeps(bytes: &[u8]) {
    let Some((&choice, text)) = bytes.split_first() else {
        return;
    };
    let input = Cursor::new(text.to_vec());
    // A row takes a byte and a line end at least, but for the last.
    let most = text.len().div_ceil(2);
    match stream("fuzz.csv", Box::new(input), &chosen(choice)) {
        Ok(mut source) => whole::read(&mut *source, most),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
