//! `inm live`: record a board, and watch its Allan deviation grow.

mod bench;
mod captures;

use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::Context;
use clap::Args;

use self::bench::Bench;
use self::captures::Captures;
use super::recording::BoardOptions;
use super::results::ResultOptions;
use super::{interrupt, output, recording};
use crate::analyse::{AnalysisOptions, summarise};
use crate::live::{Artist, Controls, Desk, Screen, ScreenArtist, Stage};
use crate::page::PageArtist;

/// Arguments of `inm live`.
#[derive(Debug, Args)]
pub struct LiveCommand {
    #[command(flatten)]
    board: BoardOptions,
    /// Capture to write; it must not exist yet. Without one the name is the date, in the current
    /// folder: inm-20261123T090507Z.inmcap.
    #[arg(short, long, value_name = "FILE", conflicts_with = "no_record")]
    output: Option<PathBuf>,
    /// Write no capture: only the statistics are kept.
    #[arg(long)]
    no_record: bool,
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
    /// Runs the subcommand. Ctrl-C ends the recording and prints the noise table, that of the last
    /// recording where there were several.
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
        let desk = Desk::new(stop.clone());
        let mut bench = Bench::new(&self.board, self.captures(), desk.clone(), stop.clone());
        let source = bench.start(self.board.settings())?;
        let interrupt = Arc::new(move || interrupt::interrupted(&stop));
        let mut stage = Stage::new(self.artists(Controls { desk, interrupt }, listener)?);
        let last = bench.run(source, &mut stage);
        stage.close();
        let (told, complete) = bench.told();
        self.results.say(&told)?;
        let analysis = summarise(&last.signal, &last.record, &AnalysisOptions::default());
        self.results.write(&analysis)?;
        last.ended?;
        Ok(recording::recorded(complete))
    }

    /// Where the recording goes.
    fn captures(&self) -> Captures {
        match &self.output {
            _ if self.no_record => Captures::None,
            None => Captures::Dated,
            Some(path) => Captures::Named {
                path: path.clone(),
                used: false,
            },
        }
    }

    /// Who shows the recordings.
    fn artists(
        &self,
        controls: Controls,
        listener: Option<TcpListener>,
    ) -> anyhow::Result<Vec<Box<dyn Artist>>> {
        let mut artists: Vec<Box<dyn Artist>> = Vec::new();
        let mut url = None;
        if let Some(listener) = listener {
            let page = PageArtist::start(listener, controls.clone());
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
        artists.push(ScreenArtist::on(screen, url));
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
