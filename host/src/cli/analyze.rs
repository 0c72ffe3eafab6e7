//! `inm analyze`: Allan deviation and noise coefficients of a record.

use clap::{Args, ValueEnum};

use super::input::InputOptions;
use super::output;
use super::results::ResultOptions;
use crate::analyse::{self, AnalysisOptions};
use crate::bins::taus::Taus;
use crate::source::open::open;

/// Arguments of `inm analyze`.
#[derive(Debug, Args)]
pub struct Analyze {
    /// Record to read: a capture, an array file, or - for standard input.
    file: String,
    #[command(flatten)]
    input: InputOptions,
    /// Averaging times: quarter (four an octave), octave, decade, all, or numbers of samples.
    #[arg(long, default_value = "quarter")]
    taus: Taus,
    /// Which differences to average: strided (bounded memory) or full (every one) [default:
    /// strided, or full where the averaging times need it].
    #[arg(long)]
    overlap: Option<Overlap>,
    /// Averaging times of the published fit in samples, five or more; the nearest of those that
    /// the overlap has are taken [default: 17, log-spaced from 1 to 1/2.5 of the record].
    #[arg(
        long,
        value_name = "M1,M2,...",
        value_delimiter = ',',
        value_parser = clap::value_parser!(u64).range(1..)
    )]
    published_taus: Option<Vec<u64>>,
    #[command(flatten)]
    results: ResultOptions,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Overlap {
    Strided,
    Full,
}

impl Analyze {
    /// The overlap asked for; where none is, the one that can serve the averaging times.
    fn overlap(&self) -> anyhow::Result<analyse::Overlap> {
        let on_grid = matches!(self.taus, Taus::Quarter | Taus::Octave);
        match self.overlap {
            Some(Overlap::Full) => Ok(analyse::Overlap::Full),
            Some(Overlap::Strided) if !on_grid => anyhow::bail!(
                "--overlap strided knows the averaging times of --taus quarter and octave only; \
                 leave it out, or say --overlap full"
            ),
            Some(Overlap::Strided) => Ok(analyse::Overlap::Strided),
            None if on_grid => Ok(analyse::Overlap::Strided),
            None => Ok(analyse::Overlap::Full),
        }
    }

    /// Runs the subcommand.
    ///
    /// # Errors
    /// If the record cannot be read or a result cannot be written.
    pub fn run(self) -> anyhow::Result<()> {
        if self
            .published_taus
            .as_ref()
            .is_some_and(|taus| taus.len() < 5)
        {
            anyhow::bail!("--published-taus: five coefficients need five averaging times or more");
        }
        output::check(&self.results.outputs(), &[Some(&self.file)])?;
        let options = AnalysisOptions {
            overlap: self.overlap()?,
            taus: self.taus,
            published_taus: self.published_taus,
        };
        let mut source = open(&self.file, &self.input.into())?;
        let analysis = analyse::analyse(&mut *source, &options, |_| {})?;
        self.results.write(&analysis)?;
        self.results.write_proof(source.proof())
    }
}
