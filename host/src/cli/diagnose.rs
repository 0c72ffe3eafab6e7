//! `inm diagnose`: what a simulation of the fitted model gets wrong about a record, why, and what
//! the extended model gains.

use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use indicatif::{ProgressBar, ProgressStyle};

use super::column;
use super::input::InputOptions;
use super::output::{self, write_to};
use super::results::ResultOptions;
use crate::diagnosis::result::finding::AxisDiagnosis;
use crate::face::diagnose::{DiagnosisError, DiagnosisOptions, FAMILY_LEVEL, Step, diagnose};
use crate::model::catalogue::{self, CATALOGUE};
use crate::model::kind::Kind;
use crate::model::unnamed;
use crate::report;
use crate::source::open::open;
use crate::source::options::Selector;

/// Between two looks of the progress bar.
const TICK: Duration = Duration::from_millis(100);

/// Exit status where something is left unexplained.
const UNEXPLAINED: u8 = 1;

/// Arguments of `inm diagnose`.
#[derive(Debug, Args)]
pub struct DiagnoseCommand {
    /// Record to read: a capture, an array file, or - for standard input.
    file: String,
    #[command(flatten)]
    input: InputOptions,
    /// Column of temperatures in the same file, by number from 0 or by name.
    #[arg(long, value_name = "COLUMN")]
    temperature: Option<Selector>,
    /// Degrees that one unit of that column stands for; gains are stated for one degree.
    #[arg(
        long,
        value_name = "SCALE",
        requires = "temperature",
        allow_negative_numbers = true,
        default_value_t = 1.0
    )]
    temperature_scale: f64,
    /// Another record of the same axes: shows whether this one was taken at the rate that it says.
    #[arg(long, value_name = "FILE")]
    reference: Option<String>,
    /// A kind of effect that is suspected: where it is not found, how near it comes to a name and how large it may be
    /// is told; repeated for more.
    #[arg(long, value_name = "KIND", value_parser = kinds())]
    suspect: Vec<Kind>,
    /// Probability of any finding where nothing is hidden.
    #[arg(long, value_name = "P", default_value_t = FAMILY_LEVEL)]
    level: f64,
    /// Write the extended model to this file, as `inm simulate --model` reads it.
    #[arg(long, value_name = "OUT.json", alias = "model")]
    save_model: Option<String>,
    /// Print every decision of the search to standard error: what was taken in, declined, taken back, and searched anew.
    #[arg(long)]
    trace: bool,
    #[command(flatten)]
    results: ResultOptions,
}

impl DiagnoseCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// If the record cannot be read or holds too little, or a result cannot be written.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!(
            self.level > 0.0 && self.level < 1.0,
            "--level {}: a probability between 0 and 1",
            self.level
        );
        anyhow::ensure!(
            self.temperature_scale.is_normal(),
            "--temperature-scale {}: a number other than zero",
            self.temperature_scale
        );
        let [json, report, png] = self.results.outputs();
        output::check(
            &[json, report, png, self.save_model.as_deref()],
            &[Some(&self.file), self.reference.as_deref()],
        )?;
        let temperature = match &self.temperature {
            Some(column) => {
                let input = self.input.clone().into();
                let scale = self.temperature_scale;
                Some(column::read(&self.file, input, column, scale)?)
            }
            None => None,
        };
        let mut reference = match &self.reference {
            Some(path) => Some(open(path, &self.input.clone().into())?),
            None => None,
        };
        let mut source = open(&self.file, &self.input.into())?;
        let options = DiagnosisOptions {
            family_level: self.level,
            temperature,
            reference: reference.as_mut().map(|source| &mut **source as _),
            suspects: self.suspect,
            // Text alone does not show it.
            views: self.results.any(),
        };
        let bar = progress(source.signal().axes.len());
        let diagnosis = diagnose(&mut *source, options, &|axis, step| match step {
            Step::Begun => bar.set_message(format!("axis {axis}")),
            Step::Decided(decision) if self.trace => {
                bar.suspend(|| eprintln!("axis {axis}: {decision}"));
            }
            Step::Decided(decision) => bar.set_message(format!("axis {axis}: {decision}")),
            Step::Done => bar.inc(1),
        })
        .map_err(|error| match error {
            DiagnosisError::Source(error) => error.into(),
            DiagnosisError::Refused(refused) => anyhow::anyhow!("{}: {refused}", self.file),
        })?;
        bar.finish_and_clear();
        if let Some(path) = &self.save_model {
            write_to(path, |mut output| {
                report::json::write(&diagnosis.model(), &mut output)
            })?;
        }
        self.results.write(&diagnosis)?;
        Ok(if diagnosis.axes.iter().any(AxisDiagnosis::lacks) {
            ExitCode::from(UNEXPLAINED)
        } else {
            ExitCode::SUCCESS
        })
    }
}

/// Reads the kinds of the catalogue by their names; what has no name is none.
fn kinds() -> impl TypedValueParser<Value = Kind> {
    let named = CATALOGUE.iter().filter(|kind| **kind != unnamed::KIND);
    let names = PossibleValuesParser::new(named.map(|kind| kind.name()));
    names.try_map(|name| catalogue::find(&name).ok_or("no such kind"))
}

/// Shown on a terminal only, and gone when the text comes.
fn progress(axes: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {bar:24} {pos} of {len} axes  {msg}");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::new(axes as u64).with_style(style);
    bar.enable_steady_tick(TICK);
    bar.set_message("reading");
    bar
}
