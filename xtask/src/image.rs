//! Building the images.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use inm_protocol::slot::{FLASH, HEADER, SLOT_STARTS};

use crate::run::{cargo, output, root, run, target};
use crate::tools::TARGET;
use crate::{assemble, mark};

/// Profile of the images; link-time optimisation cannot be set for one package.
pub const PROFILE: &str = "firmware";

/// File name of the board's image as it lies in flash, from its start.
pub const BINARY: &str = "inm-board.bin";

/// The images: one source, two machines below it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Image {
    /// For the STM32F405RG: the loader, and the program for both slots.
    Board,
    /// The program for its second slot alone.
    SecondSlot,
    /// The loader alone.
    Loader,
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
            Self::SecondSlot => "inm-board-second",
            Self::Loader => "inm-loader",
            Self::Qemu => "inm-board-qemu",
            Self::Count => "inm-count",
            Self::Overflow => "inm-overflow",
        }
    }

    /// The program it is made of.
    pub fn program(self) -> &'static str {
        match self {
            Self::Board | Self::SecondSlot | Self::Qemu => "inm-board",
            Self::Loader => "inm-loader",
            Self::Count => "inm-count",
            Self::Overflow => "inm-overflow",
        }
    }

    /// Features that make it.
    pub fn features(self) -> &'static [&'static str] {
        match self {
            Self::Board | Self::Loader => &[],
            Self::SecondSlot => &["--features", "slot-b"],
            Self::Qemu | Self::Count | Self::Overflow => &["--features", "qemu"],
        }
    }

    /// Address of its vector table.
    pub fn origin(self) -> u32 {
        match self {
            Self::Board => SLOT_STARTS[0] + HEADER,
            Self::SecondSlot => SLOT_STARTS[1] + HEADER,
            Self::Loader | Self::Qemu | Self::Count | Self::Overflow => FLASH,
        }
    }

    /// Builds it and returns its ELF.
    ///
    /// Cargo gives several images one name, so each is copied to a place of its own, with revision and
    /// checksum in its mark.
    ///
    /// # Errors
    /// The build fails, or the copy.
    pub fn build(self) -> Result<PathBuf> {
        let image = self.assemble(Self::link)?;
        if self == Self::Board {
            keep(BINARY, &assemble::flat(&image)?)?;
        }
        keep(self.name(), &image)
    }

    /// Its ELF of what `link` makes, marked: that of the board has its loader and the program for the other slot in
    /// it.
    ///
    /// # Errors
    /// One cannot be linked, or has no room.
    pub fn assemble(self, link: impl Fn(Self) -> Result<Vec<u8>>) -> Result<Vec<u8>> {
        if self == Self::Board {
            let programs = [link(self)?, link(Self::SecondSlot)?];
            assemble::board(programs, &link(Self::Loader)?)
        } else {
            link(self)
        }
    }

    /// Builds what cargo makes of it, marked.
    fn link(self) -> Result<Vec<u8>> {
        run(cargo(&["build", "--package", "inm-firmware"])
            .args(["--bin", self.program()])
            .args(["--target", TARGET, "--profile", PROFILE])
            .args(self.features()))?;
        let built = target().join(TARGET).join(PROFILE).join(self.program());
        let linked =
            fs::read(&built).with_context(|| format!("cannot read {}", built.display()))?;
        mark::fill_in(linked, &revision())
            .with_context(|| format!("{} cannot be marked", built.display()))
    }
}

/// Writes an image to its place.
fn keep(name: &str, image: &[u8]) -> Result<PathBuf> {
    let kept = target().join("image").join(name);
    fs::create_dir_all(target().join("image"))?;
    fs::write(&kept, image).with_context(|| format!("cannot write {}", kept.display()))?;
    Ok(kept)
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
