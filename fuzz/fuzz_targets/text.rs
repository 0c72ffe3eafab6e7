//! `tests/src/promise/text.rs`, without end.

#![no_main]

use inm_tests::promise;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| promise::of("text")(bytes));
