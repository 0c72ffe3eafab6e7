//! `inm flash`: program the board.

use std::borrow::Cow;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use super::interrupt;
use super::output::say;
use crate::flash::{
    CHIP, FLASH_ORIGIN, FlashError, Image, Line, LogTable, Progress, attach, choose_probe, follow,
    probes, program, restart, ring, shipped,
};

/// Arguments of `inm flash`.
#[derive(Debug, Args)]
pub struct FlashCommand {
    /// The image: an ELF file as `cargo xtask firmware` builds it; the one that comes with this program if none is named.
    #[arg(value_name = "ELF")]
    pub image: Option<PathBuf>,

    /// Which probe, by any part of its name or serial number.
    #[arg(long, value_name = "TEXT")]
    pub probe: Option<String>,

    /// Hold the board in reset while the probe connects: for a program that keeps it out. Needs the wire NRST.
    #[arg(long)]
    pub connect_under_reset: bool,

    /// Follow the board's log after programming, until Ctrl-C (`inm board log --probe` does it at any time).
    #[arg(long, conflicts_with_all = ["dry_run", "list"])]
    pub log: bool,

    /// Check the image and stop: needs no probe and writes nothing.
    #[arg(long)]
    pub dry_run: bool,

    /// List the debug probes of this machine and stop.
    #[arg(long, conflicts_with_all = ["image", "probe", "connect_under_reset", "dry_run"])]
    pub list: bool,
}

impl FlashCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the image or the probe says.
    pub fn run(self) -> anyhow::Result<()> {
        if self.list {
            return list();
        }
        let file = ImageFile::read(self.image)?;
        let image = &file.image;
        say(&format!(
            "{}: {image}, {} bytes in {} segments from {FLASH_ORIGIN:#010x} for {CHIP}\n",
            file.path.display(),
            image.len(),
            image.segments.len()
        ))?;
        if self.dry_run {
            say("dry run: the image is sound; nothing was written\n")?;
            return Ok(());
        }
        // Ahead of programming: an image without a log is still an image.
        let log = self.log.then(|| file.log()).transpose()?;
        let probe = choose_probe(self.probe.as_deref())?;
        let mut session = attach(probe, self.connect_under_reset)?;
        let bars = Bars::new();
        program(&mut session, image, false, |told| bars.show(told))?;
        say("programmed, verified, restarted\n")?;
        if let Some((table, ring)) = log {
            let stop = interrupt::stop_on_signal()?;
            restart(&mut session, ring)?;
            let told = follow(
                &mut session,
                (&table, ring),
                || stop.requested(),
                |line| say(&words(&line)).map_err(anyhow::Error::from),
            );
            told?;
        }
        Ok(())
    }
}

/// Lists the probes that are plugged in.
fn list() -> anyhow::Result<()> {
    let probes = probes();
    if probes.is_empty() {
        return Err(FlashError::NoProbe.into());
    }
    Ok(say(&format!("{}\n", probes.join("\n")))?)
}

/// An image with the file that it is from.
pub(super) struct ImageFile {
    /// Where it is, or what it is called.
    pub(super) path: PathBuf,
    pub(super) image: Image,
    elf: Cow<'static, [u8]>,
}

impl ImageFile {
    /// The one at `path`, or the one that comes with this program.
    ///
    /// # Errors
    /// It cannot be read, or is no image for the board.
    pub(super) fn read(path: Option<PathBuf>) -> anyhow::Result<Self> {
        let Some(path) = path else {
            return Ok(Self {
                path: PathBuf::from(shipped::NAME),
                image: shipped::image()?,
                elf: Cow::Borrowed(shipped::BOARD),
            });
        };
        let image = Image::read(&path)?;
        let elf = std::fs::read(&path)
            .with_context(|| format!("{}: the file cannot be read", path.display()))?;
        Ok(Self {
            path,
            image,
            elf: Cow::Owned(elf),
        })
    }

    /// What reads its log: the strings, and where in RAM the ring is.
    ///
    /// # Errors
    /// It has none.
    pub(super) fn log(&self) -> anyhow::Result<(LogTable, u64)> {
        Ok((LogTable::parse(&self.elf, &self.path)?, ring(&self.elf)?))
    }
}

/// A line of the log: the board's own time, how grave, what.
pub(super) fn words(line: &Line) -> String {
    let up = line
        .up_s
        .map_or(String::new(), |up_s| format!("{up_s:.6} s"));
    let level = line.level.unwrap_or("");
    format!("{}  {up:>16}  {level:<5}  {}\n", line.at, line.what)
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
