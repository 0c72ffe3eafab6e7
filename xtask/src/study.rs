//! `cargo xtask study NAME`: the simulations that are too long for every test run.
//!
//! Each is an ignored test beside the short form of itself, so that both share their code.

use anyhow::Result;

use crate::run::{cargo, run as execute};

/// Whether the 95 % intervals hold the truth in 95 % of simulated records; prints a table.
///
/// # Errors
/// It does not build, or the coverage is not what is claimed.
pub fn intervals() -> Result<()> {
    execute(&mut cargo(&[
        "test",
        "--package",
        "inm-host",
        "--test",
        "intervals",
        "--",
        "--ignored",
        "--nocapture",
    ]))
}
