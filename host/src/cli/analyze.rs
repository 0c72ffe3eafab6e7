//! `inm analyze`: Allan deviation and noise coefficients of a record.

use std::io::Write;

use clap::{Args, ValueEnum};

use super::input::InputOptions;
use super::output::write_to;
use crate::analyse::{self, AnalysisOptions};
use crate::bins::taus::Taus;
use crate::report;
use crate::source::open::open;

/// Arguments of `inm analyze`.
#[derive(Debug, Args)]
pub struct Analyze {
    /// Record to read: an array file, or - for standard input.
    file: String,
    #[command(flatten)]
    input: InputOptions,
    /// Averaging times: quarter (four an octave), octave, decade, all, or numbers of samples.
    #[arg(long, default_value = "quarter")]
    taus: Taus,
    /// Which differences to average: strided (bounded memory) or full (every one).
    #[arg(long)]
    overlap: Option<Overlap>,
    /// Write the result as JSON to this file; - is standard output, in place of the table.
    #[arg(long, value_name = "OUT")]
    json: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Overlap {
    Strided,
    Full,
}

impl Analyze {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// If the record cannot be read or a result cannot be written.
    pub fn run(self) -> anyhow::Result<()> {
        let mut source = open(&self.file, &self.input.into())?;
        let options = AnalysisOptions {
            taus: self.taus,
            overlap: match self.overlap {
                Some(Overlap::Full) => analyse::Overlap::Full,
                _ => analyse::Overlap::Strided,
            },
        };
        let analysis = analyse::analyse(&mut *source, &options, |_| {})?;
        if let Some(path) = &self.json {
            write_to(path, |mut output| {
                report::json::write(&analysis, &mut output)
            })?;
        }
        if self.json.as_deref() != Some("-") {
            let mut output = std::io::stdout().lock();
            output.write_all(report::text::render(&analysis).as_bytes())?;
            if let Some(proof) = source.proof() {
                writeln!(output, "{proof}")?;
            }
            output.flush()?;
        }
        Ok(())
    }
}
