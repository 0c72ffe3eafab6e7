//! Linker arguments of the images: each has its part of the flash.
//!
//! They stand here and not in `.cargo/config.toml`, because there `RUSTFLAGS` would replace
//! them without a word and the image would link to nothing.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// The memory map of the programs. The linker would find one at the root of the workspace before any other.
const MEMORY: &str = "memory.x";

/// The programs that have it.
const PROGRAMS: [&str; 3] = ["inm-board", "inm-count", "inm-overflow"];

/// The loader's own: the first sector, and of the RAM what the programs have for their stacks.
/// `_loader_asked` is where memory.x has it.
const LOADER: &str = "\
MEMORY
{
  FLASH : ORIGIN = 0x08000000, LENGTH = 16K
  RAM   : ORIGIN = 0x20000000, LENGTH = 32K
}
_loader_asked = 0x2001fff0;
";

/// The flash of a program. `xtask` holds these to `inm_protocol::slot`.
fn flash() -> &'static str {
    let has = |feature: &str| env::var_os(format!("CARGO_FEATURE_{feature}")).is_some();
    match (has("QEMU"), has("SLOT_B")) {
        // QEMU starts what lies at the start of the flash; it has no loader.
        (true, _) => "MEMORY { FLASH : ORIGIN = 0x08000000, LENGTH = 768K }\n",
        // Behind their headers of 512 bytes.
        (_, false) => "MEMORY { FLASH : ORIGIN = 0x08020200, LENGTH = 256K - 512 }\n",
        (_, true) => "MEMORY { FLASH : ORIGIN = 0x08060200, LENGTH = 256K - 512 }\n",
    }
}

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed={MEMORY}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return Ok(());
    }
    let out = env::var_os("OUT_DIR")
        .map(PathBuf::from)
        .ok_or(io::ErrorKind::NotFound)?;
    let [program, loader] = ["program", "loader"].map(|name| out.join(name));
    fs::create_dir_all(&program)?;
    fs::create_dir_all(&loader)?;
    fs::copy(Path::new(MEMORY), program.join("memory.x"))?;
    fs::write(program.join("flash.x"), flash())?;
    fs::write(loader.join("memory.x"), LOADER)?;
    for name in PROGRAMS {
        println!("cargo:rustc-link-arg-bin={name}=-L{}", program.display());
    }
    println!("cargo:rustc-link-arg-bin=inm-loader=-L{}", loader.display());
    // --nmagic: sections need no alignment to pages, of which the part has none.
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    Ok(())
}
