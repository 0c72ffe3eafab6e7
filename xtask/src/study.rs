//! `cargo xtask study NAME`: the simulations that are too long for every test run.
//!
//! Those that judge are ignored tests beside the short form of themselves, so that both share their
//! code; those that measure are examples of the host's library, and print a table.

use anyhow::{Context, Result};

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
    judge("study_diagnose", options)
}

/// Whether `inm diagnose` keeps its head on records of any kind; prints a table. `options` go to the
/// study.
///
/// # Errors
/// It does not build, the options are wrong, or a record fails.
pub fn robust(options: &[&str]) -> Result<()> {
    judge("study_robust", options)
}

/// Whether `inm diagnose` says what happened on an ordinary desk; prints tables. `options` go to the study.
///
/// # Errors
/// It does not build, or the options are wrong.
pub fn everyday(options: &[&str]) -> Result<()> {
    judge("study_everyday", options)
}

/// Whether `inm diagnose` names effects that are added to stretches of real records; prints tables. `options` go to the
/// study.
///
/// # Errors
/// It does not build, or the options are wrong.
pub fn added(options: &[&str]) -> Result<()> {
    judge("study_added", options)
}

/// Whether tabs in a browser cost a sample, and hold more with time; prints what each held. `minutes` are the
/// board's; ten if `None`.
///
/// # Errors
/// It does not build, there is no browser, `minutes` is no number, a sample is missing, or a tab grows.
pub fn live(minutes: Option<&str>) -> Result<()> {
    let minutes = minutes.unwrap_or("10");
    minutes
        .parse::<u32>()
        .with_context(|| format!("`{minutes}` is no number of minutes"))?;
    execute(
        cargo(&["test", "--package", "inm-host", "--test", "live", "--"])
            .args(["--ignored", "--nocapture", "tabs_cost_no_sample_and_hold"])
            .env("INM_STUDY_MINUTES", minutes),
    )
}

/// Whether every sample of a night at the bench is right, flagged or known to be missing; prints a
/// table. `options` go to the study: `--help` lists them.
///
/// # Errors
/// It does not build, the options are wrong, a sample is wrong, or memory grows.
pub fn night(options: &[&str]) -> Result<()> {
    judge("study_night", options)
}

/// Random fault runs; prints a table. `options` are the first seed and the number of runs, or `--kills`
/// and how many recordings are to be killed.
///
/// # Errors
/// It does not build, the options are wrong, a wrong sample was taken for good, or a recording that was
/// killed lacks what it had written.
pub fn faults(options: &[&str]) -> Result<()> {
    if options.first() == Some(&"--kills") {
        return judge("study_kills", options);
    }
    // Not in release: the rules that only debug builds check are worth more than the time.
    let mut runs = cargo(&["run", "--package", "inm-tests", "--example", "faults", "--"]);
    execute(runs.args(options))
}

/// Runs an example of the tests that judges `inm`, in release.
fn judge(name: &str, options: &[&str]) -> Result<()> {
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
    study.args(["--example", name, "--", "--inm"]);
    study.arg(program.with_extension(std::env::consts::EXE_EXTENSION));
    execute(study.args(options))
}

/// Runs an example of the host's library that simulates `records` records; its own number if
/// `None`.
///
/// # Errors
/// It does not build or fails, or `records` is no number.
pub fn example(name: &str, records: Option<&str>) -> Result<()> {
    let mut command = cargo(&[
        "run",
        "--release",
        "--package",
        "inm-host",
        "--example",
        name,
    ]);
    if let Some(records) = records {
        records
            .parse::<u64>()
            .with_context(|| format!("`{records}` is no number of records"))?;
        command.args(["--", records]);
    }
    execute(&mut command)
}
