//! The header of a capture: whatever stands there is refused, or is a header that can be written and
//! read again, with numbers that a recording can have.

use std::path::Path;

use inm_host::internals::capture::Reader;

/// First line of every capture.
const MAGIC: &[u8] = b"#inm-capture 1\n";

/// Reads `bytes` as the second line.
pub fn keeps(bytes: &[u8]) {
    let path = Path::new("fuzz.inmcap");
    let whole = [MAGIC, bytes, b"\n"].concat();
    let reader = match Reader::new(&whole[..], path) {
        Ok(reader) => reader,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let header = reader.header();
    let line = serde_json::to_vec(header).expect("what was read can be written");
    let again = [MAGIC, &line, b"\n"].concat();
    let again = Reader::new(&again[..], path).expect("what was written can be read");
    assert!(again.header() == header, "{:?}\n{header:?}", again.header());
    if let Ok(signal) = header.signal(path) {
        assert!(signal.axes.iter().all(|axis| axis.scale.is_finite()));
    }
}
