//! `inm export`: a noise model in the format of another program.

use clap::Args;

use super::output::{self, write_to};
use crate::export::input::Input;
use crate::export::{Format, export};

/// Arguments of `inm export`.
#[derive(Debug, Args)]
pub struct Export {
    /// published, published:X (Y, Z), a model file, or the JSON of inm analyze or inm diagnose.
    model: String,
    /// Format to write.
    #[arg(long)]
    to: Format,
    /// File to write; - is standard output.
    #[arg(short, long, value_name = "OUT")]
    output: String,
    /// Longest averaging time that matters, seconds [default: half the record, 2700 for a model].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    longest: Option<f64>,
}

impl Export {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// If there is no such model, the format cannot hold it, or the file cannot be written.
    pub fn run(self) -> anyhow::Result<()> {
        output::check(&[Some(&self.output)], &[Some(&self.model)])?;
        let mut input = Input::open(&self.model)?;
        if let Some(longest_s) = self.longest {
            input.set_longest(longest_s).map_err(anyhow::Error::msg)?;
        }
        let bytes = export(&input, self.to)?;
        write_to(&self.output, |output| output.write_all(&bytes))
    }
}
