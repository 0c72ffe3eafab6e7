//! `cargo xtask study NAME`: the simulations that are too long for every test run.
//!
//! Each shares its code with the short form of itself among the tests.

use anyhow::Result;

use crate::run::{cargo, run as execute, target};

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

/// How well `inm diagnose` finds hidden effects; prints tables. `options` go to the study:
/// `--help` lists them.
///
/// # Errors
/// It does not build, or the options are wrong.
pub fn diagnose(options: &[&str]) -> Result<()> {
    let build = [
        "build",
        "--release",
        "--package",
        "inm-host",
        "--bin",
        "inm",
    ];
    execute(&mut cargo(&build))?;
    let program = target().join("release").join("inm");
    let mut study = cargo(&["run", "--release", "--package", "inm-tests"]);
    study.args(["--example", "study_diagnose", "--", "--inm"]);
    study.arg(program.with_extension(std::env::consts::EXE_EXTENSION));
    execute(study.args(options))
}
