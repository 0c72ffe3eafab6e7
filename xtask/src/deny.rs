//! `cargo xtask deny`: licences and sources of all dependencies, and the defects of theirs that are
//! known, by `deny.toml`.
//!
//! The licences are a test, too, which needs no tool: whoever adds a dependency learns of it at once.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, bail};

use crate::run::{cargo, output, run as execute};

/// What is missing where cargo-deny is.
const MISSING: &str = "cargo-deny is missing: cargo install cargo-deny --locked";

/// Runs cargo-deny.
///
/// # Errors
/// It is missing, or finds something.
pub fn run() -> Result<()> {
    if !is_installed() {
        bail!("{MISSING}");
    }
    execute(&mut cargo(&[
        "deny",
        "--all-features",
        "check",
        "licenses",
        "bans",
        "sources",
    ]))?;
    if !has_advisories() {
        eprintln!(
            "\nleft out: known defects, whose list cannot be had from here (cargo deny fetch db)"
        );
        return Ok(());
    }
    let known = [
        "deny",
        "--all-features",
        "check",
        "--disable-fetch",
        "advisories",
    ];
    execute(&mut cargo(&known))
}

/// As [`run`], where cargo-deny is installed; says that it is missing where not.
///
/// # Errors
/// It finds something.
pub fn check() -> Result<()> {
    if is_installed() {
        return run();
    }
    eprintln!("\nleft out: {MISSING}; the licences were tested without it");
    Ok(())
}

fn is_installed() -> bool {
    output(&mut cargo(&["deny", "--version"])).is_ok()
}

/// Whether the list of known defects is there: fetched now, or an earlier time.
fn has_advisories() -> bool {
    if output(&mut cargo(&["deny", "fetch", "db"])).is_ok() {
        return true;
    }
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(std::env::home_dir()?.join(".cargo")));
    let lists = home.and_then(|home| std::fs::read_dir(home.join("advisory-dbs")).ok());
    lists.is_some_and(|mut lists| {
        let has_head = |list: std::io::Result<std::fs::DirEntry>| {
            let list = list.ok()?.path();
            let head = Command::new("git")
                .arg("-C")
                .arg(list)
                .args(["rev-parse", "HEAD"])
                .output();
            head.ok()?.status.success().then_some(())
        };
        lists.any(|list| has_head(list).is_some())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::root;
    use serde_json::Value;
    use spdx::{Expression, LicenseReq, ParseMode};

    /// What stands between quotes in the list that begins with `begin`.
    fn listed<'t>(text: &'t str, begin: &str) -> Vec<&'t str> {
        let list = text
            .split(begin)
            .nth(1)
            .and_then(|rest| rest.split(']').next());
        let words = list.expect("a list in deny.toml").split('"');
        words.skip(1).step_by(2).collect()
    }

    fn is_allowed(licence: &str, allowed: &[&str]) -> bool {
        let read = Expression::parse_mode(licence, ParseMode::LAX);
        let read = read.unwrap_or_else(|error| panic!("{licence}: {error}"));
        let knows = |one: &LicenseReq| allowed.contains(&one.to_string().as_str());
        read.evaluate(knows)
    }

    #[test]
    fn licences_of_all_dependencies_are_allowed() {
        let text = std::fs::read_to_string(root().join("deny.toml")).expect("deny.toml");
        let allowed = listed(&text, "\nallow = [");
        let exceptions = listed(&text, "\nexceptions = [{ allow = [");
        let arguments = [
            "metadata",
            "--format-version",
            "1",
            "--all-features",
            "--locked",
        ];
        let metadata = output(&mut cargo(&arguments)).expect("cargo metadata");
        let metadata: Value = serde_json::from_str(&metadata).expect("JSON");
        let packages = metadata["packages"].as_array().expect("a list");
        assert!(
            packages.len() > 100,
            "all of the lock file: {}",
            packages.len()
        );
        for package in packages {
            let [name, licence] = ["name", "license"].map(|key| package[key].as_str());
            let (name, licence) = (name.expect("a name"), licence.unwrap_or("none"));
            let excepted = name == "serialport" && is_allowed(licence, &exceptions);
            assert!(
                excepted || is_allowed(licence, &allowed),
                "{name} is under {licence}; deny.toml allows {allowed:?}"
            );
        }
    }

    #[test]
    fn a_licence_that_asks_for_more_is_refused() {
        let allowed = ["MIT", "Apache-2.0"];
        assert!(is_allowed("MIT/Apache-2.0", &allowed));
        assert!(is_allowed("MIT OR GPL-3.0-only", &allowed));
        assert!(!is_allowed("MIT AND GPL-3.0-only", &allowed));
        assert!(!is_allowed("GPL-2.0-or-later", &allowed));
    }
}
