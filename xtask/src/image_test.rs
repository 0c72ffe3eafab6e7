//! `cargo xtask image-test`: the image of the board, unmodified, on a model of its chip: the workspace `image-test`, where the
//! tools that build it are there. What it is and why it is apart stands in its README.md.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use anyhow::{Result, bail};

use crate::image::Image;
use crate::run::{cargo, output, run as execute, target};
use crate::tools::ensure_target;

/// Environment variable by which the tests find the image.
const IMAGE_VARIABLE: &str = "INM_BOARD_IMAGE";

/// Where systems keep libraries.
const LIBRARIES: [&str; 5] = [
    "/usr/lib",
    "/usr/lib64",
    "/usr/local/lib",
    "/opt/homebrew/opt/llvm/lib",
    "/usr/local/opt/llvm/lib",
];

/// Builds the image and tests it.
///
/// # Errors
/// A tool is missing (says which), or something fails.
pub fn run() -> Result<()> {
    if let Some(missing) = missing() {
        bail!("{missing}");
    }
    ensure_target()?;
    test(&Image::Board.build()?)
}

/// Format, lints and tests, where the tools are there; says what is missing where not. Installs nothing.
///
/// # Errors
/// Something fails.
pub fn check(image: &Path) -> Result<()> {
    if let Some(missing) = missing() {
        eprintln!("\nleft out: {missing}");
        return Ok(());
    }
    test(image)
}

fn test(image: &Path) -> Result<()> {
    execute(cargo(&["fmt", "--check"]).args(manifest()))?;
    execute(
        built(&["clippy", "--all-targets"])
            .args(["--", "--deny", "warnings"])
            .env(IMAGE_VARIABLE, image),
    )?;
    execute(
        built(&["test"])
            .args(["--", "--nocapture"])
            .env(IMAGE_VARIABLE, image),
    )
}

/// cargo in that workspace, building below the folder of all that is built.
fn built(arguments: &[&str]) -> Command {
    let mut command = cargo(arguments);
    command.args(manifest());
    command.arg("--target-dir").arg(target().join("image-test"));
    command
}

fn manifest() -> [&'static str; 2] {
    ["--manifest-path", "image-test/Cargo.toml"]
}

/// What is not installed, and how to get it.
fn missing() -> Option<String> {
    let starts = |program: &str| output(Command::new(program).arg("--version")).is_ok();
    let tool = if !starts("cmake") {
        "cmake"
    } else if !starts("cc") {
        "a C compiler, cc"
    } else if !has_libclang() {
        "libclang"
    } else {
        return None;
    };
    Some(format!(
        "the image on a model of its chip needs {tool} for its processor emulator; on Debian: \
         sudo apt-get install cmake gcc libclang-dev"
    ))
}

/// Whether bindgen will find libclang: where it is told to look, and where libraries usually are, or one
/// or two folders further down.
fn has_libclang() -> bool {
    let told = env::var_os("LIBCLANG_PATH").map(PathBuf::from);
    let usual = LIBRARIES.iter().flat_map(|folder| {
        let below = entries(Path::new(folder));
        let further = below.iter().map(|folder| folder.join("lib"));
        let further: Vec<_> = further.collect();
        [PathBuf::from(folder)]
            .into_iter()
            .chain(below)
            .chain(further)
    });
    let mut folders = told.into_iter().chain(usual);
    folders.any(|folder| entries(&folder).iter().any(|file| is_libclang(file)))
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let all = fs::read_dir(folder).into_iter().flatten();
    all.filter_map(|entry| Some(entry.ok()?.path())).collect()
}

/// The library of C functions, whatever its version; its C++ brother is of no use.
fn is_libclang(file: &Path) -> bool {
    let name = file.file_name().map(OsString::from).unwrap_or_default();
    let name = name.to_string_lossy();
    let library = name.contains(".so") || name.ends_with(".dylib");
    name.starts_with("libclang") && !name.starts_with("libclang-cpp") && library
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::root;

    #[test]
    fn libclang_is_known_by_its_name() {
        let is = |name: &str| is_libclang(Path::new("/usr/lib").join(name).as_path());
        for name in ["libclang.so", "libclang-14.so.1", "libclang.dylib"] {
            assert!(is(name), "{name}");
        }
        for name in ["libclang-cpp.so.14", "libclang.a", "libLLVM-14.so"] {
            assert!(!is(name), "{name}");
        }
    }

    /// What is linked with a library under GPL-2.0 is no part of what is passed on.
    #[test]
    fn nothing_else_knows_the_emulator() {
        let locked = fs::read_to_string(root().join("Cargo.lock")).expect("a lock file");
        assert!(!locked.contains("unicorn"));
        let own = fs::read_to_string(root().join("image-test/Cargo.lock")).expect("a lock file");
        assert!(own.contains("unicorn-engine"));
        let workspace = fs::read_to_string(root().join("Cargo.toml")).expect("a manifest");
        assert!(workspace.contains("exclude = [\"fuzz\", \"image-test\"]"));
    }
}
