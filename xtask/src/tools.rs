//! What the toolchain and the system must have, installed if it is missing.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::run::{output, run, run_in, target};

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

/// Environment variable that names QEMU's program to the tests.
pub const QEMU_VARIABLE: &str = "INM_QEMU";

/// Where QEMU's program is: on the path, or the project's own copy.
pub fn qemu() -> PathBuf {
    let own = own_qemu();
    if own.is_file() { own } else { QEMU.into() }
}

/// The project's own copy of QEMU: a script that starts it with its own libraries.
fn own_qemu() -> PathBuf {
    target().join("qemu").join(QEMU)
}

/// Sees to QEMU: unpacks Debian's packages of it below the folder of what is built, where it is not there.
/// Nothing of the system is installed, changed or removed, so it needs no rights either.
///
/// # Errors
/// It is missing and cannot be had from here; says how.
pub fn ensure_qemu() -> Result<()> {
    let starts = |program: &Path| {
        let version = Command::new(program).arg("--version").output();
        version.is_ok_and(|run| run.status.success())
    };
    if starts(Path::new(QEMU)) || starts(&own_qemu()) {
        return Ok(());
    }
    unpack(&target().join("qemu")).with_context(|| {
        format!(
            "the image is tested under {QEMU}, which is missing, and apt has no packages of it \
             for this machine; install it and try again, on Debian: sudo apt-get install {QEMU} \
             (read first what apt would remove)"
        )
    })?;
    if starts(&own_qemu()) {
        return Ok(());
    }
    bail!(
        "{} does not start; remove its folder and try again, or install {QEMU}",
        own_qemu().display()
    )
}

/// Unpacks QEMU and the libraries that are not installed into a folder.
fn unpack(folder: &Path) -> Result<()> {
    let root = folder.join("root");
    let packages = folder.join("packages");
    fs::create_dir_all(&root)?;
    fs::create_dir_all(&packages)?;
    let mut listed = output(&mut would_install(QEMU));
    if listed.is_err() {
        // The lists of packages may be older than the packages, or not there yet.
        run(Command::new("apt-get").args(["update"]))?;
        listed = output(&mut would_install(QEMU));
    }
    let listed = listed?;
    let names = listed.lines().filter_map(|line| line.strip_prefix("Inst "));
    let names: Vec<&str> = names.filter_map(|line| line.split(' ').next()).collect();
    let mut download = Command::new("apt-get");
    download.arg("download").args(&names);
    // Into the folder that it is run in.
    run_in(&packages, &mut download)?;
    for package in fs::read_dir(&packages)? {
        let package = package?.path();
        run(Command::new("dpkg-deb")
            .arg("--extract")
            .args([&package, &root]))?;
    }
    let script = own_qemu();
    let lib =
        ["usr/lib", "lib"].map(|lib| format!("{0}/{lib}/$(uname -m)-linux-gnu", root.display()));
    fs::write(
        &script,
        format!(
            "#!/bin/sh\nLD_LIBRARY_PATH={}:{} exec {2}/usr/bin/{QEMU} -L {2}/usr/share/qemu \"$@\"\n",
            lib[0],
            lib[1],
            root.display()
        ),
    )?;
    fs::set_permissions(&script, fs::Permissions::from_mode(0o755))?;
    Ok(())
}

/// Lists what apt would install for a package, and installs nothing.
fn would_install(package: &str) -> Command {
    let mut command = Command::new("apt-get");
    command.args(["install", "--dry-run", "--no-install-recommends", package]);
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_installed_into_the_system_or_removed_from_it() {
        let command = would_install(QEMU);
        let arguments: Vec<_> = command.get_args().collect();
        assert!(arguments.contains(&"--dry-run".as_ref()), "{command:?}");
        // No other call of apt changes packages.
        let source = include_str!("tools.rs");
        let code = source.split("#[cfg(test)]").next().unwrap_or_default();
        for changes in ["remove\"", "purge", "upgrade", "--yes"] {
            assert!(!code.contains(changes), "{changes}");
        }
        assert_eq!(code.matches("\"install\"").count(), 1);
    }
}
