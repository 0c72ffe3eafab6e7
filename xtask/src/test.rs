//! `cargo xtask test`: every check and every test.
//!
//! From the quickest to the slowest, so that what is wrong shows early. Whatever is built is
//! built once: the two images share their dependencies, the checks share theirs, and all tests
//! come from one build of the workspace.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use crate::elf::Elf;
use crate::image::Image;
use crate::run::{cargo, run as execute, target};
use crate::size;
use crate::tools::{QEMU_VARIABLE, TARGET, ensure_qemu, ensure_target, qemu};
use crate::{deny, fuzz, image_test, instructions, packages, shipped};

/// Crates that run on the board. Each is checked alone: in a build of the workspace the host's
/// features leak into what they share.
const NO_STD: [&str; 5] = [
    "inm-protocol",
    "inm-allan",
    "ads1281",
    "inm-emulator",
    "inm-firmware",
];

/// Environment variable by which the tests under QEMU find the image.
const IMAGE_VARIABLE: &str = "INM_QEMU_IMAGE";

/// And the one that fills its stack.
const OVERFLOW_VARIABLE: &str = "INM_QEMU_OVERFLOW";

/// Environment variable from which proptest takes its seed. With a fixed one a rare case cannot
/// fail a change that has nothing to do with it; plain `cargo test` goes on to explore.
const PROPTEST_VARIABLE: &str = "PROPTEST_RNG_SEED";
const PROPTEST_SEED: &str = "20261121";

/// Runs everything, up to the first failure. What needs nothing installed comes first.
///
/// # Errors
/// Something could not be installed, or failed.
pub fn run() -> Result<()> {
    listed(run_all)
}

/// What needs neither an image nor QEMU, and nothing installed: while one works on the host.
///
/// # Errors
/// Something failed.
pub fn quick() -> Result<()> {
    listed(|stages| {
        check_sources(stages)?;
        test_workspace(stages)
    })
}

/// Runs stages, and lists them at the end, whatever came of them.
fn listed(all: impl FnOnce(&mut Stages) -> Result<()>) -> Result<()> {
    let mut stages = Stages::default();
    let result = all(&mut stages);
    eprint!("\n{}", stages.table());
    result
}

/// Whatever the compiler sees on any machine.
fn check_sources(stages: &mut Stages) -> Result<()> {
    stages.run("format", || {
        execute(&mut cargo(&["fmt", "--all", "--check"]))
    })?;
    stages.run("lints", check_on_the_host)
}

/// Every test of the workspace but those of the image; a failure keeps none of the others from
/// being told.
fn test_workspace(stages: &mut Stages) -> Result<()> {
    eprintln!("\nproperty tests: {PROPTEST_VARIABLE}={PROPTEST_SEED}");
    stages.run("tests", || {
        execute(
            cargo(&["test", "--workspace", "--no-fail-fast"]).env(PROPTEST_VARIABLE, PROPTEST_SEED),
        )
    })
}

fn run_all(stages: &mut Stages) -> Result<()> {
    check_sources(stages)?;
    stages.run("tools", || ensure_target().and_then(|()| ensure_qemu()))?;
    stages.run("checks for the board", check_for_the_board)?;
    let board = stages.run("image of the board", || check_image(Image::Board))?;
    stages.run("loader", || check_image(Image::Loader))?;
    stages.run("image that comes with `inm`", shipped::check)?;
    let qemu = stages.run("image for QEMU", || check_image(Image::Qemu))?;
    let overflow = stages.run("image that overflows", || Image::Overflow.build())?;
    stages.run("instructions", instructions::check)?;
    stages.run("documentation", || {
        execute(cargo(&["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "--deny warnings"))
    })?;
    stages.run("packages", packages::check)?;
    test_workspace(stages)?;
    stages.run("image that `inm flash` takes", || flash_takes(&board))?;
    stages.run("tests under QEMU", || test_image(&qemu, &overflow))?;
    stages.run("image on its chip", || image_test::check(&board))?;
    stages.run("dependencies", deny::check)?;
    stages.run("fuzzing", fuzz::check)
}

/// Has `inm flash` look at the image of the board; its own tests know images that are made up.
fn flash_takes(image: &Path) -> Result<()> {
    // The program that the tests have built: `cargo run` would build it anew, as the features of the workspace are not those
    // of this package alone.
    let inm = target().join("debug/inm");
    execute(Command::new(inm).args(["flash", "--dry-run"]).arg(image))
}

/// What was run, and how long it took.
#[derive(Default)]
struct Stages {
    done: Vec<(&'static str, Duration)>,
}

impl Stages {
    fn run<T>(&mut self, name: &'static str, stage: impl FnOnce() -> Result<T>) -> Result<T> {
        let begin = Instant::now();
        let result = stage();
        self.done.push((name, begin.elapsed()));
        result.with_context(|| format!("stage `{name}`"))
    }

    /// A line for each stage, and their sum.
    fn table(&self) -> String {
        let all = self.done.iter().map(|(_, took)| *took).sum();
        let lines = self.done.iter().copied().chain([("all", all)]);
        lines
            .map(|(name, took)| format!("{name:<22}{:>8.1} s\n", took.as_secs_f64()))
            .collect()
    }
}

/// What runs on the board, by the compiler alone.
fn check_for_the_board() -> Result<()> {
    for package in NO_STD {
        execute(&mut cargo(&[
            "check",
            "--lib",
            "--target",
            TARGET,
            "--package",
            package,
        ]))?;
    }
    for image in [Image::Board, Image::Qemu] {
        execute(
            cargo(&["clippy", "--package", "inm-firmware", "--target", TARGET])
                .args(image.features())
                .args(["--", "--deny", "warnings"]),
        )?;
    }
    Ok(())
}

/// Builds an image and holds it to its budget; its ELF.
fn check_image(image: Image) -> Result<PathBuf> {
    let path = image.build()?;
    size::check(image, &Elf::read(&path, image.origin())?)?;
    Ok(path)
}

fn check_on_the_host() -> Result<()> {
    execute(&mut cargo(&[
        "clippy",
        "--workspace",
        "--all-targets",
        "--",
        "--deny",
        "warnings",
    ]))
}

/// The image's tests, which plain `cargo test` ignores. The whole workspace is named again so
/// that cargo finds what it has built for the others.
fn test_image(image: &Path, overflow: &Path) -> Result<()> {
    execute(
        cargo(&[
            "test",
            "--workspace",
            "--test",
            "qemu",
            "--",
            "--ignored",
            "--nocapture",
        ])
        .env(IMAGE_VARIABLE, image)
        .env(OVERFLOW_VARIABLE, overflow)
        .env(QEMU_VARIABLE, qemu()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stages_are_listed_with_the_one_that_failed() {
        let mut stages = Stages::default();
        stages.run("first", || Ok(())).expect("no failure");
        let failed = stages.run("second", || -> Result<()> { anyhow::bail!("broken") });
        assert_eq!(
            format!("{:#}", failed.expect_err("a failure")),
            "stage `second`: broken"
        );
        let table = stages.table();
        let names: Vec<_> = table
            .lines()
            .map(|line| line.split("  ").next().unwrap_or_default())
            .collect();
        assert_eq!(names, ["first", "second", "all"]);
    }
}
