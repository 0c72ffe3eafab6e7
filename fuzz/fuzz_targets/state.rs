//! `allan/tests/any_state`, without end.

#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../allan/tests/any_state/mod.rs"]
mod any_state;

fuzz_target!(|bytes: &[u8]| {
    any_state::try_state(bytes);
});
