//! Building the images.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::mark;
use crate::run::{cargo, output, root, run, target};
use crate::tools::TARGET;

/// Profile of the images; link-time optimisation cannot be set for one package.
pub const PROFILE: &str = "firmware";

/// The images: one source, two machines below it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Image {
    /// For the STM32F405RG.
    Board,
    /// For QEMU's model of it, converters emulated inside.
    Qemu,
    /// The same, counting its instructions.
    Count,
    /// The machine below it, filling its stack.
    Overflow,
}

impl Image {
    /// File name of the ELF.
    pub fn name(self) -> &'static str {
        match self {
            Self::Board => "inm-board",
            Self::Qemu => "inm-board-qemu",
            Self::Count => "inm-count",
            Self::Overflow => "inm-overflow",
        }
    }

    /// The program it is made of.
    pub fn program(self) -> &'static str {
        match self {
            Self::Board | Self::Qemu => "inm-board",
            Self::Count => "inm-count",
            Self::Overflow => "inm-overflow",
        }
    }

    /// Features that make it.
    pub fn features(self) -> &'static [&'static str] {
        match self {
            Self::Board => &[],
            Self::Qemu | Self::Count | Self::Overflow => &["--features", "qemu"],
        }
    }

    /// Builds it and returns its ELF.
    ///
    /// Cargo gives both images one name, so each is copied to a place of its own, with revision and
    /// checksum in its mark.
    ///
    /// # Errors
    /// The build fails, or the copy.
    pub fn build(self) -> Result<PathBuf> {
        run(cargo(&["build", "--package", "inm-firmware"])
            .args(["--bin", self.program()])
            .args(["--target", TARGET, "--profile", PROFILE])
            .args(self.features()))?;
        let target = target();
        let built = target.join(TARGET).join(PROFILE).join(self.program());
        let kept = target.join("image").join(self.name());
        fs::create_dir_all(target.join("image"))?;
        let linked =
            fs::read(&built).with_context(|| format!("cannot read {}", built.display()))?;
        let marked = mark::fill_in(linked, &revision())
            .with_context(|| format!("{} cannot be marked", built.display()))?;
        fs::write(&kept, marked).with_context(|| format!("cannot write {}", kept.display()))?;
        Ok(kept)
    }
}

/// Revision of the source, with `, changed` behind it where files differ from it; `unknown` without git.
fn revision() -> String {
    let git = |arguments: &[&str]| {
        let mut git = Command::new("git");
        git.current_dir(root()).args(arguments);
        output(&mut git).ok()
    };
    let head = git(&["rev-parse", "--short=12", "HEAD"]);
    let changes = git(&["status", "--porcelain", "--untracked-files=no"]);
    match (head, changes) {
        (Some(head), Some(changes)) if changes.trim().is_empty() => head.trim().to_owned(),
        (Some(head), _) => format!("{}, changed", head.trim()),
        (None, _) => "unknown".to_owned(),
    }
}
