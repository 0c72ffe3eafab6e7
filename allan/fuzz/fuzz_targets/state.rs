//! Any bytes, read as a state: refused, or usable without a panic, and written back as they were.

#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../tests/any_state/mod.rs"]
mod any_state;

fuzz_target!(|bytes: &[u8]| {
    any_state::try_state(bytes);
});
