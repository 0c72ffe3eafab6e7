//! `inm simulate`: data from a noise model, as an array file or a capture.

use std::path::Path;

use anyhow::Context;
use clap::Args;

use super::column;
use super::output::{self, write_to};
use crate::chain::Chain;
use crate::face::simulate::{correlation, samples, simulate};
use crate::model::published::DURATION_S;
use crate::model::whole::Model;
use crate::simulate::capture::write_capture;
use crate::simulate::file::{write_csv, write_npy};
use crate::source::options::{ArrayOptions, Selector};

/// Ending of a capture's name.
const CAPTURE: &str = ".inmcap";

/// Arguments of `inm simulate`.
#[derive(Debug, Args)]
pub struct Simulate {
    /// Noise model: published (three axes), published:X, published:Y, published:Z, or a model
    /// file (docs/reference/model-file.md).
    #[arg(long)]
    model: String,
    /// File to write: .csv for text, .inmcap for a capture with integer codes, anything else a
    /// NumPy array; - is standard output.
    #[arg(short, long, value_name = "FILE")]
    output: String,
    /// Seed of the random numbers; the same seed gives the same data.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Length in seconds.
    #[arg(long, value_name = "S", allow_negative_numbers = true, default_value_t = DURATION_S)]
    duration: f64,
    /// Samples a second [default: those of the model].
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    rate: Option<f64>,
    /// Signal chain of all axes in place of the model's, such as ads1281:linear+400hz.
    #[arg(long)]
    chain: Option<Chain>,
    /// Correlation of the axes' noise: the part above the diagonal, row by row (for X, Y, Z:
    /// XY,XZ,YZ).
    #[arg(
        long,
        value_name = "R,...",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    correlation: Option<Vec<f64>>,
    /// Array file with the temperature, one value a sample, for axes that follow it. It becomes
    /// the last column of the output, which is no capture then.
    #[arg(long, value_name = "FILE")]
    temperature: Option<String>,
    /// Its column, by number from 0 or by name.
    #[arg(
        long,
        value_name = "COLUMN",
        requires = "temperature",
        default_value = "0"
    )]
    temperature_column: Selector,
}

impl Simulate {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// If there is no such model, duration and rate give no samples, or the file cannot be
    /// written.
    pub fn run(self) -> anyhow::Result<()> {
        output::check(
            &[Some(&self.output)],
            &[Some(&self.model), self.temperature.as_deref()],
        )?;
        let mut model = Model::open(&self.model)?;
        if let Some(rate_hz) = self.rate {
            model.rate_hz = rate_hz;
        }
        if let Some(chain) = &self.chain {
            for axis in &mut model.axes {
                axis.chain = Some(chain.clone());
            }
        }
        if let Some(upper) = &self.correlation {
            let matrix = correlation(upper, model.axes.len()).map_err(anyhow::Error::msg)?;
            model.correlation = Some(matrix);
        }
        let samples = samples(self.duration, model.rate_hz).map_err(anyhow::Error::msg)?;
        let temperature = match &self.temperature {
            Some(file) => {
                let options = ArrayOptions {
                    rate_hz: Some(model.rate_hz),
                    ..ArrayOptions::default()
                };
                anyhow::ensure!(
                    !self.output.to_ascii_lowercase().ends_with(CAPTURE),
                    "{}: a capture has no room for the temperature; write .npy or .csv instead",
                    self.output
                );
                let column = column::read(file, options, &self.temperature_column, 1.0)?;
                anyhow::ensure!(
                    column.len() as u64 >= samples,
                    "{file}: column {} has {} values, one a sample; {samples} samples were asked \
                     for: give a longer record, or --duration {}",
                    self.temperature_column,
                    column.len(),
                    column.len() as f64 / model.rate_hz
                );
                Some(column)
            }
            None => None,
        };
        let mut simulation = simulate(&model, samples, self.seed, temperature)
            .map_err(anyhow::Error::msg)
            .with_context(|| format!("--model {}", self.model))?;
        let ending = |end| self.output.to_ascii_lowercase().ends_with(end);
        if ending(CAPTURE) {
            return write_capture(&mut simulation, Path::new(&self.output));
        }
        write_to(&self.output, |mut output| {
            if ending(".csv") {
                write_csv(&mut simulation, &mut output)
            } else {
                write_npy(&mut simulation, &mut output)
            }
        })
    }
}
