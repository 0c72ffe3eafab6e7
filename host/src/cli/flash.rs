//! `inm flash`: program the board.

use std::path::PathBuf;

use clap::Args;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use probe_rs::Permissions;

use super::output::say;
use crate::flash::{CHIP, FLASH_ORIGIN, FlashError, Image, Progress, choose_probe, program};

/// Arguments of `inm flash`.
#[derive(Debug, Args)]
pub struct FlashCommand {
    /// The image: the ELF file that `cargo xtask firmware` builds.
    #[arg(value_name = "ELF")]
    pub image: PathBuf,

    /// Which probe, by any part of its name or serial number.
    #[arg(long, value_name = "TEXT")]
    pub probe: Option<String>,

    /// Check the image and stop: needs no probe and writes nothing.
    #[arg(long)]
    pub dry_run: bool,
}

impl FlashCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the image or the probe says.
    pub fn run(self) -> anyhow::Result<()> {
        let image = Image::read(&self.image)?;
        say(&format!(
            "{}: firmware {} of revision {}, {} bytes in {} segments from {FLASH_ORIGIN:#010x} for {CHIP}\n",
            self.image.display(),
            image.version,
            image.revision,
            image.len(),
            image.segments.len()
        ))?;
        if self.dry_run {
            say("dry run: the image is sound; nothing was written\n")?;
            return Ok(());
        }
        let probe = choose_probe(self.probe.as_deref())?;
        let mut session = probe
            .attach(CHIP, Permissions::default())
            .map_err(FlashError::Attach)?;
        let bars = Bars::new();
        program(&mut session, &image, false, |told| bars.show(told))?;
        Ok(say("programmed, verified, restarted\n")?)
    }
}

/// One bar a stage, in the order in which they are announced.
struct Bars {
    all: MultiProgress,
    style: ProgressStyle,
    bars: std::cell::RefCell<Vec<(&'static str, ProgressBar)>>,
}

impl Bars {
    fn new() -> Self {
        let style = ProgressStyle::with_template(
            "{prefix:>8} [{bar:30}] {bytes}/{total_bytes} {bytes_per_sec}",
        )
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("#>-");
        Self {
            all: MultiProgress::new(),
            style,
            bars: std::cell::RefCell::default(),
        }
    }

    fn show(&self, told: Progress) {
        let mut bars = self.bars.borrow_mut();
        match told {
            Progress::Stage(name, total) => {
                let bar = ProgressBar::new(total).with_style(self.style.clone());
                bar.set_prefix(name);
                bars.push((name, self.all.add(bar)));
            }
            Progress::Bytes(name, bytes) => {
                if let Some((_, bar)) = bars.iter().find(|(stage, _)| *stage == name) {
                    bar.inc(bytes);
                    if bar.position() >= bar.length().unwrap_or(0) {
                        bar.finish();
                    }
                }
            }
        }
    }
}
