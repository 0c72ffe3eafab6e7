//! What every reader of the program promises of any bytes whatever: an answer or a clear error, in
//! bounded time and memory, and never a panic. A file a reader.
//!
//! `tests/tests/promises.rs` holds them to it with the seeds of `fuzz/corpus` and with damaged copies,
//! in every run; `cargo xtask fuzz` looks for bytes that break one without end.

mod capture;
mod elf;
mod frames;
mod header;
mod model;
mod npy;
mod options;
mod pieces;
mod text;
mod whole;

/// Panics if the reader does not keep its promise for these bytes.
pub type Promise = fn(&[u8]);

/// Every reader, by the name of its fuzz target. `state`, of `inm-allan`, is tried by that crate.
pub const ALL: [(&str, Promise); 7] = [
    ("capture", capture::keeps),
    ("elf", elf::keeps),
    ("frames", frames::keeps),
    ("header", header::keeps),
    ("model", model::keeps),
    ("npy", npy::keeps),
    ("text", text::keeps),
];

/// The promise of the reader `name`.
///
/// # Panics
/// If there is none.
pub fn of(name: &str) -> Promise {
    let found = ALL.iter().find(|(one, _)| *one == name);
    found.unwrap_or_else(|| panic!("no promise `{name}`")).1
}
