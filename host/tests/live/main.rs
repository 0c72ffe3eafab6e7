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
