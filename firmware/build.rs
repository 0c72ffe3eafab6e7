//! Linker arguments of the image.
//!
//! They stand here and not in `.cargo/config.toml`, because there `RUSTFLAGS` would replace
//! them without a word and the image would link to nothing.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// The memory map, at the root of the workspace.
const MEMORY: &str = "../memory.x";

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed={MEMORY}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return Ok(());
    }
    let out = env::var_os("OUT_DIR")
        .map(PathBuf::from)
        .ok_or(io::ErrorKind::NotFound)?;
    fs::copy(Path::new(MEMORY), out.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    // --nmagic: sections need no alignment to pages, of which the part has none.
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    Ok(())
}
