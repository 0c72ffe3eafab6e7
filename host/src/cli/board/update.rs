//! `inm board update`: a new program over the serial line.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::JsonOption;
use super::which::connect;
use crate::flash::{Image, shipped};
use crate::update::{Progress, Updated, update};

/// Arguments of `inm board update`.
#[derive(Debug, Args)]
pub struct UpdateCommand {
    /// The image: an ELF file as `cargo xtask firmware` builds it; the one that comes with this program if none is named.
    /// Of it the program for the slot that is free is taken; the loader stays as it is.
    #[arg(value_name = "ELF")]
    image: Option<PathBuf>,
    /// Serial port of the board (`/dev/ttyUSB0`, `COM3`), or `virtual` for one without hardware.
    #[arg(long, value_name = "PORT")]
    port: String,
    /// Speed of the serial port, bit/s.
    #[arg(long, value_name = "BIT_PER_S", default_value_t = 921_600)]
    baud: u32,
    #[command(flatten)]
    json: JsonOption,
}

impl UpdateCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the image, the port or the board says.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        self.json.check()?;
        // Before anything is said to the board.
        let image = match &self.image {
            Some(path) => Image::read(path)?,
            None => shipped::image()?,
        };
        let bar = Bar::new();
        let updated = update(connect(&self.port, self.baud).as_mut(), &image, |told| {
            bar.show(told);
        });
        bar.clear();
        let updated = updated?;
        self.json.write(&updated, &text(&updated))?;
        Ok(ExitCode::SUCCESS)
    }
}

fn text(updated: &Updated) -> String {
    let before = updated.before.as_ref().map_or_else(
        || "its loader listened".to_owned(),
        |release| format!("firmware {release}"),
    );
    format!(
        "{}: board {}: {before} before, now firmware {} of revision {}, {} bytes in slot {}, verified; it answers\n",
        updated.port,
        updated.serial,
        updated.firmware,
        updated.revision,
        updated.bytes,
        updated.slot
    )
}

/// How far it is, where somebody looks.
struct Bar(ProgressBar);

impl Bar {
    fn new() -> Self {
        let style = ProgressStyle::with_template("{msg:>8} [{bar:30}] {bytes}/{total_bytes}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(0).with_style(style.progress_chars("#>-"));
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    fn show(&self, told: Progress) {
        self.0.set_message(match told {
            Progress::Enter => "loader",
            Progress::Erase => "erase",
            Progress::Write { .. } => "write",
            Progress::Verify => "verify",
            Progress::Start => "start",
        });
        if let Progress::Write { written, of } = told {
            self.0.set_length(of.into());
            self.0.set_position(written.into());
        }
    }

    fn clear(&self) {
        self.0.finish_and_clear();
    }
}
