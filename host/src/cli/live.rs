//! `inm live`: record a board, and watch its Allan deviation grow.

use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::Context;
use clap::Args;

use super::interrupt;
use super::output;
use super::recording::BoardOptions;
use super::results::ResultOptions;
use crate::analyse::{AnalysisOptions, summarise};
use crate::bins::record::{Overlap, Record};
use crate::live::{Artist, Controls, Screen, ScreenArtist, watch};
use crate::page::PageArtist;
use crate::source::Source;
use crate::source::board::{BoardSource, Stop};

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
    /// Serve a page for browsers, on this machine alone unless another address is given. The address to
    /// open, with its secret, is printed.
    #[arg(
        long,
        value_name = "ADDRESS:PORT",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "127.0.0.1:0"
    )]
    page: Option<SocketAddr>,
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
        // Before the board is asked for anything.
        let listener = self.page.map(listen).transpose()?;
        let stop = interrupt::stop_on_signal()?;
        let connect = self.board.connect(1.0);
        let capture = self.output.as_deref();
        let mut source = BoardSource::start(connect, self.board.plan(), capture, stop.clone())?;
        let signal = source.signal().clone();
        let artists = self.artists(&source, stop, listener)?;
        let mut record = Record::new(signal.axes.len(), Overlap::Strided);
        let ended = watch(&mut source, Some(&mut record), artists);
        let analysis = summarise(&signal, &record, &AnalysisOptions::default());
        self.results.write(&analysis)?;
        ended?;
        Ok(super::recording::recorded(&source))
    }

    /// Who shows the recording.
    fn artists(
        &self,
        source: &BoardSource,
        stop: Stop,
        listener: Option<TcpListener>,
    ) -> anyhow::Result<Vec<Box<dyn Artist>>> {
        let interrupted = stop.clone();
        let controls = Controls {
            stop,
            interrupt: Arc::new(move || interrupt::interrupted(&interrupted)),
            marks: Some(source.marks()),
        };
        let signal = source.signal();
        let mut artists: Vec<Box<dyn Artist>> = Vec::new();
        let mut url = None;
        if let Some(listener) = listener {
            let page = PageArtist::start(listener, controls.clone(), signal, source.capture_path());
            let page = page.context("--page: the page cannot be served")?;
            // The view shows it too, where there is one.
            eprintln!("page: {}", page.url());
            url = Some(page.url().to_owned());
            artists.push(Box::new(page));
        }
        let screen = if self.plain {
            Screen::lines()
        } else {
            Screen::terminal(controls)
        };
        artists.push(ScreenArtist::on(screen, signal, url));
        Ok(artists)
    }
}

/// Where the page is served; all addresses at once have no name that a request could be held to.
fn listen(address: SocketAddr) -> anyhow::Result<TcpListener> {
    anyhow::ensure!(
        !address.ip().is_unspecified(),
        "--page {address}: is every address of this machine; give the one by which browsers reach it"
    );
    TcpListener::bind(address).with_context(|| {
        format!(
            "--page {address}: cannot be listened at; give another port, or 0 for any that is free"
        )
    })
}
