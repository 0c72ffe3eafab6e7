//! `inm replay`: a capture down the path that live data take.

use std::path::PathBuf;

use clap::Args;

use super::output;
use super::recording::parse_speed;
use super::results::ResultOptions;
use crate::analyse::{AnalysisOptions, summarise};
use crate::bins::record::{Overlap, Record};
use crate::live::{ScreenArtist, watch};
use crate::source::capture::CaptureSource;
use crate::source::{Source, SourceError};

/// Arguments of `inm replay`.
#[derive(Debug, Args)]
pub struct ReplayCommand {
    /// Capture to replay.
    #[arg(value_name = "FILE")]
    capture: PathBuf,
    /// Seconds of the record in a second; 0 for as fast as it goes.
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = parse_speed
    )]
    speed: f64,
    #[command(flatten)]
    results: ResultOptions,
}

impl ReplayCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the capture says.
    pub fn run(self) -> anyhow::Result<()> {
        let capture = self.capture.to_str();
        output::check(&self.results.outputs(), &[capture])?;
        let source = CaptureSource::open(&self.capture).map_err(SourceError::from)?;
        let mut source = source.at_speed(self.speed);
        let signal = source.signal().clone();
        let mut record = Record::new(signal.axes.len(), Overlap::Strided);
        let screen = ScreenArtist::lines();
        let ended = watch(&mut source, Some(&mut record), screen);
        self.results
            .write(&summarise(&signal, &record, &AnalysisOptions::default()))?;
        Ok(ended?)
    }
}
