//! `inm live` as a person at the bench uses it.

#![cfg(unix)]

mod bench;
mod browser;
mod files;
mod page;
mod pictures;
#[path = "../pty/mod.rs"]
mod pty;
mod served;
mod terminal;

use std::process::Command;

#[test]
fn live_says_what_its_options_mean() {
    let output = Command::new(env!("CARGO_BIN_EXE_inm"))
        .args(["live", "--help"])
        .output()
        .expect("inm runs");
    assert!(output.status.success());
    insta::assert_snapshot!(String::from_utf8_lossy(&output.stdout));
}
