//! `inm record`: samples of a board into a capture.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::interrupt;
use super::output::say;
use super::recording::BoardOptions;
use crate::live::{ScreenArtist, watch};
use crate::source::Source;
use crate::source::board::BoardSource;

/// Arguments of `inm record`.
#[derive(Debug, Args)]
pub struct RecordCommand {
    #[command(flatten)]
    board: BoardOptions,
    /// Capture to write; it must not exist yet.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

impl RecordCommand {
    /// Runs the subcommand. Ctrl-C ends the recording in good order.
    ///
    /// # Errors
    /// What the board or the file says; what was recorded until then stays.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let stop = interrupt::stop_on_signal()?;
        let connect = self.board.connect(0.0);
        let plan = self.board.plan(self.board.settings());
        let mut source = BoardSource::start(connect, plan, Some(&self.output), stop)?;
        let screen = ScreenArtist::lines();
        let ended = watch(&mut source, None, screen);
        // Said in either case: a recording that broke off is still a recording.
        say(&self.told(&source))?;
        ended?;
        Ok(super::recording::recorded(source.losses().gaps == 0))
    }

    /// What there is to say of a recording that came to its end.
    fn told(&self, source: &BoardSource) -> String {
        let mut told = format!(
            "{}: {} samples an axis, {} lost, {} bytes\n",
            self.output.display(),
            source.next_index(),
            source.losses().lost_samples,
            source.captured_bytes()
        );
        if let Some(proof) = source.proof() {
            told += &format!("{proof}\n");
        }
        for gap in source.unknown_gaps() {
            told += &format!(
                "after sample {}: {}; how many are missing is not known\n",
                gap.from, gap.cause
            );
        }
        told
    }
}
