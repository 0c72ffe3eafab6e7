//! What an image is built from, as one number: its crates' files, the crates of others with their versions and
//! features, the memory map, the profile. No test, no page and no crate of the host is in it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use crc::{CRC_64_XZ, Crc};

use crate::image::Image;
use crate::run::{cargo, output, root};
use crate::tools::TARGET;

/// Change is by accident or by work, not by malice: a number of 64 bits tells it.
const DIGEST: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// Files beside the crates.
const BESIDE: [&str; 2] = ["firmware/memory.x", ".cargo/config.toml"];

/// Sections of the workspace's manifest that an image depends on. What others it has of it shows in the crates.
const SECTIONS: [&str; 3] = [
    "[workspace.package]",
    "[profile.firmware",
    "[profile.release",
];

/// The digest of what an image is built from, with more that it depends on.
///
/// # Errors
/// Cargo does not say what the image is made of, or a file cannot be read.
pub fn digest(image: Image, more: &[&str]) -> Result<u64> {
    let mut digest = DIGEST.digest();
    let mut add = |name: &str, bytes: &[u8]| {
        digest.update(name.as_bytes());
        digest.update(&(bytes.len() as u64).to_le_bytes());
        digest.update(bytes);
    };
    for one in more {
        add("flag", one.as_bytes());
    }
    let manifest = fs::read_to_string(root().join("Cargo.toml"))?;
    add("Cargo.toml", sections(&manifest).as_bytes());
    let (crates, folders) = crates(image)?;
    add("crates", crates.as_bytes());
    let mut files: BTreeSet<PathBuf> = BESIDE.iter().map(PathBuf::from).collect();
    for folder in folders {
        files.insert(folder.join("Cargo.toml"));
        let script = folder.join("build.rs");
        if root().join(&script).is_file() {
            files.insert(script);
        }
        collect(&folder.join("src"), &mut files)?;
    }
    for file in files {
        let bytes = fs::read(root().join(&file));
        let bytes = bytes.with_context(|| format!("cannot read {}", file.display()))?;
        // The same on systems with other separators.
        add(&file.to_string_lossy().replace('\\', "/"), &bytes);
    }
    Ok(digest.finalize())
}

/// The crates of an image, one a line with version and features, and the folders of those that are here.
fn crates(image: Image) -> Result<(String, BTreeSet<PathBuf>)> {
    let mut tree = cargo(&["tree", "--locked", "--package", "inm-firmware"]);
    tree.args(["--target", TARGET, "--edges", "normal,build"])
        .args(["--prefix", "none", "--format", "{p}|{f}"])
        .args(image.features());
    let (mut lines, mut folders) = (BTreeSet::new(), BTreeSet::new());
    for line in output(&mut tree)?.lines() {
        let line = line.trim_end_matches(" (*)").trim_end();
        let (name, features) = line.split_once('|').unwrap_or((line, ""));
        let Some((crate_of_ours, path)) = name.split_once(" (/") else {
            lines.insert(line.to_owned());
            continue;
        };
        let folder = PathBuf::from(format!("/{}", path.trim_end_matches(')')));
        lines.insert(format!("{crate_of_ours}|{features}"));
        folders.insert(within(&folder)?);
    }
    ensure!(
        !folders.is_empty(),
        "cargo names no crate of this workspace"
    );
    Ok((lines.into_iter().collect::<Vec<_>>().join("\n"), folders))
}

/// A folder of the workspace, from its root.
fn within(folder: &Path) -> Result<PathBuf> {
    let root = root();
    let relative = folder.strip_prefix(&root);
    Ok(relative
        .with_context(|| format!("{} is outside of {}", folder.display(), root.display()))?
        .to_owned())
}

/// All files below a folder of the workspace.
fn collect(folder: &Path, files: &mut BTreeSet<PathBuf>) -> Result<()> {
    let entries = fs::read_dir(root().join(folder));
    for entry in entries.with_context(|| format!("cannot read {}", folder.display()))? {
        let entry = entry?;
        let path = folder.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            collect(&path, files)?;
        } else {
            files.insert(path);
        }
    }
    Ok(())
}

/// The sections of a manifest that matter here, without comments.
fn sections(manifest: &str) -> String {
    let mut within = false;
    let mut kept = String::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            within = SECTIONS.iter().any(|section| line.starts_with(section));
        }
        if within && !line.starts_with('#') && !line.is_empty() {
            kept += line;
            kept.push('\n');
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_manifest_what_the_image_is_built_by_counts() {
        let manifest = "[workspace.package]\nversion = \"1.0.0\"\n\n[workspace.dependencies]\nclap = \"4\"\n\
                        [profile.firmware]\n# why\nlto = \"fat\"\n[profile.dev]\ndebug = 1\n";
        assert_eq!(
            sections(manifest),
            "[workspace.package]\nversion = \"1.0.0\"\n[profile.firmware]\nlto = \"fat\"\n"
        );
    }

    #[test]
    fn an_image_is_of_the_firmware_and_not_of_the_host() {
        let (lines, folders) = crates(Image::Board).expect("cargo's list");
        for ours in ["firmware", "protocol", "allan", "ads1281"] {
            assert!(folders.contains(Path::new(ours)), "{ours}: {folders:?}");
        }
        assert!(!folders.contains(Path::new("host")) && !folders.contains(Path::new("emulator")));
        assert!(
            lines.contains("postcard v") && !lines.contains("probe-rs"),
            "{lines}"
        );
        // Another flag is another image.
        let digests = [&[][..], &["more"]].map(|more| digest(Image::Board, more).expect("sources"));
        assert_ne!(digests[0], digests[1]);
    }
}
