//! `inm simulate`: data from a noise model, as an array file or a capture.

use std::path::Path;

use anyhow::Context;
use clap::Args;

use super::column;
use super::output::write_to;
use crate::chain::Chain;
use crate::model::published::DURATION_S;
use crate::model::whole::Model;
use crate::simulate::capture::write_capture;
use crate::simulate::file::{write_csv, write_npy};
use crate::simulate::source::Simulation;
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
            model.correlation = Some(symmetric(upper, model.axes.len())?);
        }
        let length = (self.duration * model.rate_hz).round();
        // Written so that NaN is refused as well.
        let sound = model.rate_hz > 0.0 && length >= 1.0 && length < 2_f64.powi(53);
        anyhow::ensure!(
            sound,
            "--duration {} at --rate {} gives no samples; both are numbers above zero",
            self.duration,
            model.rate_hz
        );
        let (samples, seed) = (length as u64, self.seed);
        let simulation = match &self.temperature {
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
                Simulation::at_temperature(&model, samples, seed, column)
            }
            None => Simulation::new(&model, samples, seed),
        };
        let mut simulation = simulation
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

/// The matrix with `upper` above and below a diagonal of 1.
fn symmetric(upper: &[f64], axes: usize) -> anyhow::Result<Vec<Vec<f64>>> {
    let wanted = axes * (axes - 1) / 2;
    anyhow::ensure!(
        upper.len() == wanted,
        "--correlation has {} numbers; {axes} axes have {wanted} pairs",
        upper.len()
    );
    let mut matrix = vec![vec![1.0; axes]; axes];
    let pairs = (0..axes).flat_map(|i| (i + 1..axes).map(move |j| (i, j)));
    for ((i, j), &value) in pairs.zip(upper) {
        matrix[i][j] = value;
        matrix[j][i] = value;
    }
    Ok(matrix)
}
