//! `inm simulate`: data from a noise model, as an array file.

use clap::Args;

use super::output::write_to;
use crate::model::published::{DURATION_S, PublishedAxis, RATE_HZ};
use crate::signal::Unit;
use crate::simulate::file::{write_csv, write_npy};
use crate::simulate::source::{SimulatedAxis, Simulation};

/// Arguments of `inm simulate`.
#[derive(Debug, Args)]
pub struct Simulate {
    /// Noise model: published:X, published:Y or published:Z, or published for all three axes.
    #[arg(long, value_parser = model)]
    model: Model,
    /// File to write: .csv for text, anything else a NumPy array; - is standard output.
    #[arg(short, long, value_name = "FILE")]
    output: String,
    /// Seed of the random numbers; the same seed gives the same data.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Length in seconds.
    #[arg(long, value_name = "S", allow_negative_numbers = true, default_value_t = DURATION_S)]
    duration: f64,
    /// Samples a second.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, default_value_t = RATE_HZ)]
    rate: f64,
}

/// The axes to simulate.
#[derive(Debug, Clone)]
struct Model(Vec<SimulatedAxis>);

fn model(text: &str) -> Result<Model, String> {
    let axes: Vec<SimulatedAxis> = PublishedAxis::ALL
        .into_iter()
        .filter(|axis| text == "published" || text == format!("published:{}", axis.name()))
        .map(|axis| SimulatedAxis {
            name: axis.name().to_owned(),
            unit: Unit::MetrePerSecondSquared,
            coefficients: axis.coefficients(),
        })
        .collect();
    if axes.is_empty() {
        return Err("no such model; published, published:X, published:Y or published:Z".into());
    }
    Ok(Model(axes))
}

impl Simulate {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// If duration and rate give no samples, or the file cannot be written.
    pub fn run(self) -> anyhow::Result<()> {
        let length = (self.duration * self.rate).round();
        // Written so that NaN is refused as well.
        let sound = self.rate > 0.0 && length >= 1.0 && length < 2_f64.powi(53);
        anyhow::ensure!(
            sound,
            "--duration {} at --rate {} gives no samples; both are numbers above zero",
            self.duration,
            self.rate
        );
        let mut simulation = Simulation::new(&self.model.0, self.rate, length as u64, self.seed);
        let as_text = self.output.to_ascii_lowercase().ends_with(".csv");
        write_to(&self.output, |mut output| {
            if as_text {
                write_csv(&mut simulation, &mut output)
            } else {
                write_npy(&mut simulation, &mut output)
            }
        })
    }
}
