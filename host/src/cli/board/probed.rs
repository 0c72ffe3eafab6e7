//! `inm board log --probe`: the log of a board through a debug probe, while it runs.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Args;

use super::sink::{LONGEST_S, Sink};
use crate::cli::flash::{ImageFile, words};
use crate::cli::interrupt;
use crate::flash::{Line, attach, choose_probe, follow, runs};

/// Options of a log through a probe.
#[derive(Debug, Args)]
pub(super) struct ProbeOptions {
    /// Through a debug probe in place of the serial port: all that the firmware logs, with the board's own time. Which probe,
    /// by any part of its name or serial number, where there are several. The board goes on as it is.
    #[arg(
        long,
        value_name = "TEXT",
        num_args = 0..=1,
        default_missing_value = "",
        conflicts_with_all = ["port", "serial", "ask", "baud"]
    )]
    probe: Option<String>,
    /// With --probe: the image that the board runs, an ELF file with its log table; the one that comes with this
    /// program if none is named.
    #[arg(long, value_name = "ELF", requires = "probe")]
    image: Option<PathBuf>,
}

impl ProbeOptions {
    /// Whether it goes through a probe.
    pub(super) fn is_asked_for(&self) -> bool {
        self.probe.is_some()
    }

    /// Follows the log for so many seconds, until Ctrl-C if none are given.
    ///
    /// # Errors
    /// What the image or the probe says, and what writes the lines.
    pub(super) fn run(self, duration: Option<f64>, sink: &mut Sink) -> anyhow::Result<ExitCode> {
        let file = ImageFile::read(self.image)?;
        let (table, ring) = file.log()?;
        let stop = interrupt::stop_on_signal()?;
        let wanted = self.probe.filter(|text| !text.is_empty());
        // Not under reset: who reads the log of a board that runs does not restart it.
        let mut session = attach(choose_probe(wanted.as_deref())?, false)?;
        runs(&mut session, &file.image)?;
        let begun = Instant::now();
        let ends = duration.map(|s| begun + Duration::from_secs_f64(s.min(LONGEST_S)));
        let over = || stop.requested() || ends.is_some_and(|end| Instant::now() >= end);
        follow(&mut session, (&table, ring), over, |line: Line| {
            sink.write(&line, &words(&line))
        })?;
        Ok(ExitCode::SUCCESS)
    }
}
