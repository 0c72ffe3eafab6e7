//! What the toolchain and the system must have, installed if it is missing.

use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::run::{output, run};

/// The board's target.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The machine that the image is tested in.
pub const QEMU: &str = "qemu-system-arm";

/// Sees to the target's standard library.
///
/// # Errors
/// It is missing and rustup cannot add it.
pub fn ensure_target() -> Result<()> {
    let libraries =
        output(Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]))?;
    if std::path::Path::new(libraries.trim()).is_dir() {
        return Ok(());
    }
    run(Command::new("rustup").args(["target", "add", TARGET]))
        .with_context(|| format!("the image needs the target {TARGET}: rustup target add {TARGET}"))
}

/// Sees to QEMU.
///
/// # Errors
/// It is missing and cannot be installed from here; says how.
pub fn ensure_qemu() -> Result<()> {
    if Command::new(QEMU)
        .arg("--version")
        .output()
        .is_ok_and(|run| run.status.success())
    {
        return Ok(());
    }
    let is_root = output(Command::new("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
    let has_apt = Command::new("apt-get").arg("--version").output().is_ok();
    if !(is_root && has_apt) {
        bail!(
            "the image is tested under {QEMU}, which is missing; install it and try again, on \
             Debian: sudo apt-get install {QEMU}"
        );
    }
    run(Command::new("apt-get").args(["update"]))
        .and_then(|()| run(&mut install(QEMU)))
        .with_context(|| {
            format!(
                "apt could not install {QEMU} beside what is installed; nothing was removed. If \
                 it names packages that are in the way, decide by hand: `apt-get install {QEMU}` \
                 lists what it would remove and asks first. Any {QEMU} on the path will do"
            )
        })
}

/// Installs a package and asks nothing. `--no-remove`: whose machine it is decides what goes, so
/// apt fails where something would have to.
fn install(package: &str) -> Command {
    let mut command = Command::new("apt-get");
    command.env("DEBIAN_FRONTEND", "noninteractive").args([
        "install",
        "--yes",
        "--no-remove",
        "--no-install-recommends",
        package,
    ]);
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn installing_never_removes_what_is_there() {
        let command = install(QEMU);
        let arguments: Vec<_> = command.get_args().collect();
        assert_eq!(arguments.first(), Some(&"install".as_ref()));
        assert_eq!(arguments.last(), Some(&QEMU.as_ref()));
        assert!(arguments.contains(&"--no-remove".as_ref()), "{arguments:?}");
    }
}
