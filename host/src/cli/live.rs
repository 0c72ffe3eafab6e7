//! `inm live`: record a board, and watch its Allan deviation grow.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use clap::Args;

use super::interrupt;
use super::output;
use super::recording::BoardOptions;
use super::results::ResultOptions;
use crate::analyse::{AnalysisOptions, summarise};
use crate::bins::record::{Overlap, Record};
use crate::live::{Controls, Screen, watch};
use crate::source::Source;
use crate::source::board::BoardSource;

/// Arguments of `inm live`.
#[derive(Debug, Args)]
pub struct LiveCommand {
    #[command(flatten)]
    board: BoardOptions,
    /// Capture to write; it must not exist yet. Without one, only the statistics are kept.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Lines instead of a view of the whole terminal, for screen readers and logs.
    #[arg(long)]
    plain: bool,
    #[command(flatten)]
    results: ResultOptions,
}

impl LiveCommand {
    /// Runs the subcommand. Ctrl-C ends the recording and prints the noise table.
    ///
    /// # Errors
    /// What the board or a file says; what was recorded until then stays, and is analysed.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let [json, report, png] = self.results.outputs();
        let capture = self.output.as_deref().and_then(Path::to_str);
        output::check(&[capture, json, report, png], &[])?;
        let stop = interrupt::stop_on_signal()?;
        let connect = self.board.connect(1.0);
        let capture = self.output.as_deref();
        let mut source = BoardSource::start(connect, self.board.plan(), capture, stop.clone())?;
        let signal = source.signal().clone();
        let mut record = Record::new(signal.axes.len(), Overlap::Strided);
        let screen = if self.plain {
            Screen::lines()
        } else {
            Screen::terminal(Controls {
                interrupt: Arc::new(move || interrupt::interrupted(&stop)),
                marks: Some(source.marks()),
            })
        };
        let ended = watch(&mut source, Some(&mut record), screen);
        let analysis = summarise(&signal, &record, &AnalysisOptions::default());
        self.results.write(&analysis)?;
        ended?;
        Ok(super::recording::recorded(&source))
    }
}
