//! `cargo xtask test`: every check and every test.
//!
//! From the quickest to the slowest, so that what is wrong shows early. Whatever is built is
//! built once: the two images share their dependencies, the checks share theirs, and all tests
//! come from one build of the workspace.

use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::elf::Elf;
use crate::image::Image;
use crate::instructions;
use crate::run::{cargo, run as execute};
use crate::size;
use crate::tools::{TARGET, ensure_qemu, ensure_target};

/// Crates that run on the board. Each is checked alone: in a build of the workspace the host's
/// features leak into what they share.
const NO_STD: [&str; 4] = ["inm-protocol", "inm-allan", "inm-emulator", "inm-firmware"];

/// Environment variable by which the tests under QEMU find the image.
const IMAGE_VARIABLE: &str = "INM_QEMU_IMAGE";

/// Environment variable from which proptest takes its seed. With a fixed one a rare case cannot
/// fail a change that has nothing to do with it; plain `cargo test` goes on to explore.
const PROPTEST_VARIABLE: &str = "PROPTEST_RNG_SEED";
const PROPTEST_SEED: &str = "20261121";

/// Runs everything, up to the first failure.
///
/// # Errors
/// Something could not be installed, or failed.
pub fn run() -> Result<()> {
    ensure_target()?;
    ensure_qemu()?;
    execute(&mut cargo(&["fmt", "--all", "--check"]))?;
    check_for_the_board()?;
    check_image(Image::Board)?;
    let qemu = check_image(Image::Qemu)?;
    instructions::check()?;
    check_on_the_host()?;
    eprintln!("\nproperty tests: {PROPTEST_VARIABLE}={PROPTEST_SEED}");
    execute(cargo(&["test", "--workspace"]).env(PROPTEST_VARIABLE, PROPTEST_SEED))?;
    test_image(&qemu)
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
    size::check(image, &Elf::read(&path)?)?;
    Ok(path)
}

/// Lints and documentation.
fn check_on_the_host() -> Result<()> {
    let all = [
        "clippy",
        "--workspace",
        "--all-targets",
        "--",
        "--deny",
        "warnings",
    ];
    execute(&mut cargo(&all))?;
    execute(cargo(&["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "--deny warnings"))
}

/// The image's tests, which plain `cargo test` ignores. The whole workspace is named again so
/// that cargo finds what it has built for the others.
fn test_image(image: &Path) -> Result<()> {
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
        .env(IMAGE_VARIABLE, image),
    )
}
