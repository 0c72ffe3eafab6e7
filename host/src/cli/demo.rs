//! `inm demo`: the whole chain in one command, without hardware.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;

use super::interrupt;
use super::results::ResultOptions;
use crate::analyse::{AnalysisOptions, summarise};
use crate::bins::record::{Overlap, Record};
use crate::live::{Screen, watch};
use crate::source::Source;
use crate::source::board::{BoardSource, Plan};
use crate::source::virtual_board::VirtualConnect;

/// Arguments of `inm demo`.
#[derive(Debug, Args)]
pub struct DemoCommand {
    /// Seconds of board time; the published experiment took 1.5 h.
    #[arg(long, value_name = "S", default_value_t = 5400.0)]
    duration: f64,
    /// Folder for capture, JSON, HTML and PNG; what an earlier demo left there is replaced.
    #[arg(long, value_name = "FOLDER", default_value = "inm-demo")]
    output: PathBuf,
    /// Seed of the virtual board's noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl DemoCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn run(self) -> anyhow::Result<()> {
        let place = |name: &str| self.output.join(name);
        std::fs::create_dir_all(&self.output)
            .with_context(|| format!("{}: the folder cannot be made", self.output.display()))?;
        let capture = place("demo.inmcap");
        forget(&capture)?;

        println!(
            "A virtual board: three MMA7331L with the published noise, three ADS1281 at register\n\
             level, the firmware's own code, a 921600 baud link. Seed {}, {} s at 2000/s.\n",
            self.seed, self.duration
        );
        let stop = interrupt::stop_on_signal()?;
        let plan = Plan {
            settings: Some(inm_protocol::Settings::default()),
            samples: Some((self.duration * 2000.0) as u64),
            ..Plan::default()
        };
        let connect = Box::new(VirtualConnect::published(self.seed, 0.0));
        let mut source = BoardSource::start(connect, plan, Some(&capture), stop)?;
        let signal = source.signal().clone();
        let mut record = Record::new(signal.axes.len(), Overlap::Strided);
        watch(&mut source, Some(&mut record), &mut Screen::stderr())?;

        let results = ResultOptions {
            json: Some(text(&place("demo.json"))),
            report: Some(text(&place("demo.html"))),
            png: Some(text(&place("demo.png"))),
        };
        println!();
        results.write(&summarise(&signal, &record, &AnalysisOptions::default()))?;
        println!("\n{}", capture.display());
        for path in [&results.json, &results.report, &results.png]
            .into_iter()
            .flatten()
        {
            println!("{path}");
        }
        println!("\nAgain from the file: inm analyze {}", capture.display());
        Ok(())
    }
}

/// Removes what an earlier demo left.
fn forget(path: &Path) -> anyhow::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("{}: cannot be replaced", path.display()))
        }
        _ => Ok(()),
    }
}

fn text(path: &Path) -> String {
    path.display().to_string()
}
