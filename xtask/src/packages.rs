//! The crates that are published by themselves: what goes into their packages, and that it builds alone.

use anyhow::{Result, bail};

use crate::run::{cargo, output, run};

/// Crates without anything of this project in them.
const PUBLISHED: [&str; 2] = ["ads1281", "inm-allan"];

/// What a package is of no use without.
const NEEDED: [&str; 4] = ["README.md", "LICENSE-MIT", "LICENSE-APACHE", "src/lib.rs"];

/// Packs each and builds it from its package, without the network. What `cargo publish --dry-run` does
/// beyond that is to ask the registry.
///
/// # Errors
/// A file is missing in a package, or it does not build by itself.
pub fn check() -> Result<()> {
    for package in PUBLISHED {
        let list = output(&mut cargo(&[
            "package",
            "--list",
            "--allow-dirty",
            "--package",
            package,
        ]))?;
        if let Some(missing) = missing(&list) {
            bail!("{package}: {missing} is not in its package: see `include` of its manifest");
        }
        run(&mut cargo(&[
            "package",
            "--offline",
            "--allow-dirty",
            "--package",
            package,
        ]))?;
    }
    Ok(())
}

/// The first file that is needed and not listed.
fn missing(list: &str) -> Option<&'static str> {
    NEEDED
        .into_iter()
        .find(|needed| !list.lines().any(|line| line == *needed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_without_its_readme_is_found() {
        let whole = "Cargo.toml\nLICENSE-APACHE\nLICENSE-MIT\nREADME.md\nsrc/lib.rs\n";
        assert_eq!(missing(whole), None);
        assert_eq!(
            missing(&whole.replace("README.md\n", "")),
            Some("README.md")
        );
        assert_eq!(missing("docs/README.md\n"), Some("README.md"));
    }
}
