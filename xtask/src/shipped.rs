//! `cargo xtask image`: the images that come with `inm`, so that who installs it needs no target for the board.
//!
//! ```text
//!   host/image/NAME.elf   as built, with its log table and symbols, without debug information
//!   host/image/NAME.txt   what it was built from and with: a digest of the sources, the compiler
//! ```
//!
//! Paths of the machine are mapped away, so that a second build, wherever it lies, gives the same bytes. The revision in
//! an image's mark is the digest of its sources: that of a commit cannot be known ahead of it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::image::{Image, PROFILE};
use crate::mark;
use crate::run::{cargo, output, root, run as execute, target};
use crate::sources;
use crate::tools::{TARGET, ensure_target};

/// The images that come with `inm`.
const SHIPPED: [Image; 1] = [Image::Board];

/// Where they lie: in the crate that holds them.
const FOLDER: &str = "host/image";

/// How they are built: part of what they are built from.
const FLAGS: [&str; 2] = [
    "profile.firmware.debug=0",
    "profile.firmware.strip=\"debuginfo\"",
];

/// Builds each and writes it with its record.
///
/// # Errors
/// A build fails, or a file cannot be written.
pub fn run() -> Result<()> {
    ensure_target()?;
    for image in SHIPPED {
        let (elf, record) = (built(image)?, record(image)?);
        let [to, beside] = files(image);
        fs::create_dir_all(root().join(FOLDER))?;
        fs::write(&to, &elf).with_context(|| format!("cannot write {}", to.display()))?;
        fs::write(&beside, record).with_context(|| format!("cannot write {}", beside.display()))?;
        println!("{}: {} bytes", to.display(), elf.len());
    }
    Ok(())
}

/// Builds each again and compares it, byte for byte; another compiler than the recorded one makes other bytes, and
/// then only the sources are compared.
///
/// # Errors
/// An image is not what its sources make, or its record is not theirs.
pub fn check() -> Result<()> {
    for image in SHIPPED {
        let [path, beside] = files(image);
        let recorded = fs::read_to_string(&beside).with_context(|| {
            format!("cannot read {}: run `cargo xtask image`", beside.display())
        })?;
        let now = record(image)?;
        let line = |text: &str, at: usize| text.lines().nth(at).unwrap_or_default().to_owned();
        ensure!(
            line(&recorded, 0) == line(&now, 0),
            "{}: the sources are others than those of the image: run `cargo xtask image`",
            beside.display()
        );
        if recorded != now {
            eprintln!(
                "{}: not compared byte for byte: built with `{}`, and here is `{}`",
                path.display(),
                line(&recorded, 1),
                line(&now, 1)
            );
            continue;
        }
        let shipped = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        ensure!(
            shipped == built(image)?,
            "{}: a second build of the same sources gives other bytes: run `cargo xtask image`",
            path.display()
        );
        eprintln!("{}: the same bytes again", path.display());
    }
    Ok(())
}

/// Image and record.
fn files(image: Image) -> [PathBuf; 2] {
    ["elf", "txt"].map(|kind| root().join(FOLDER).join(format!("{}.{kind}", image.name())))
}

/// What an image is built from and with, in words.
fn record(image: Image) -> Result<String> {
    Ok(format!("{}\n{}\n", sources_line(image)?, compiler()?))
}

/// The first line of a record.
fn sources_line(image: Image) -> Result<String> {
    Ok(format!("sources {:016x}", sources::digest(image, &FLAGS)?))
}

/// The compiler in a line: its release and commit.
fn compiler() -> Result<String> {
    let line = output(Command::new("rustc").arg("--version"))?;
    Ok(line.trim().to_owned())
}

/// Builds an image without anything of this machine in it. All of its parts are marked with its sources: they are the
/// same ones, linked for another place.
fn built(image: Image) -> Result<Vec<u8>> {
    let sources = sources_line(image)?;
    image.assemble(|part| linked(part, &sources))
}

/// Links a part of an image and marks it.
fn linked(image: Image, sources: &str) -> Result<Vec<u8>> {
    let folder = target().join("shipped");
    let mut build = cargo(&["build", "--locked", "--package", "inm-firmware"]);
    build
        .args([
            "--bin",
            image.program(),
            "--target",
            TARGET,
            "--profile",
            PROFILE,
        ])
        .args(image.features())
        .arg("--target-dir")
        .arg(&folder)
        .env("CARGO_ENCODED_RUSTFLAGS", mapped()?.join("\x1f"))
        .env_remove("RUSTFLAGS")
        // What a machine has set for itself makes other bytes: the level of the log is that of .cargo/config.toml.
        .env("CARGO_INCREMENTAL", "0")
        .env_remove("DEFMT_LOG");
    for flag in FLAGS {
        build.args(["--config", flag]);
    }
    execute(&mut build)?;
    let path = folder.join(TARGET).join(PROFILE).join(image.program());
    let linked = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    mark::fill_in(linked, sources).with_context(|| format!("{} cannot be marked", path.display()))
}

/// Options of the compiler by which no path of this machine is in an image.
fn mapped() -> Result<Vec<String>> {
    let mut maps = vec![(root(), "/inm".to_owned())];
    for registry in registries()? {
        maps.push((registry, "/registry".to_owned()));
    }
    let sysroot = output(Command::new("rustc").args(["--print", "sysroot"]))?;
    let library = Path::new(sysroot.trim()).join("lib/rustlib/src/rust");
    maps.push((library, "/rustc".to_owned()));
    let option =
        |(from, to): (PathBuf, String)| format!("--remap-path-prefix={}={to}", from.display());
    Ok(maps.into_iter().map(option).collect())
}

/// Folders with the sources of other crates, one a registry.
fn registries() -> Result<Vec<PathBuf>> {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
    let Some(sources) = home.map(|home| home.join("registry/src")) else {
        return Ok(Vec::new());
    };
    let mut folders = Vec::new();
    // Without any there are no crates of others, and the build will say so.
    for entry in fs::read_dir(&sources).into_iter().flatten() {
        folders.push(entry?.path());
    }
    folders.sort();
    Ok(folders)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_images_that_come_with_the_tool_are_of_these_sources() {
        for image in SHIPPED {
            let [path, beside] = files(image);
            let recorded = fs::read_to_string(&beside).expect("a record: run `cargo xtask image`");
            let now = sources_line(image).expect("sources");
            assert_eq!(
                recorded.lines().next(),
                Some(now.as_str()),
                "{}: the firmware has changed since: run `cargo xtask image`, and commit what it writes",
                path.display()
            );
            let elf = fs::read(&path).expect("an image: run `cargo xtask image`");
            let holds = |text: &str| {
                elf.windows(text.len())
                    .any(|place| place == text.as_bytes())
            };
            assert!(
                holds(&now),
                "{}: it is marked with other sources",
                path.display()
            );
            let home = root();
            assert!(
                !holds(&home.display().to_string()),
                "{}: it names this machine",
                path.display()
            );
        }
    }
}
