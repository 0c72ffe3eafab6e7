//! Where the result of an analysis or a diagnosis goes, shared by the subcommands that make one.

use clap::Args;

use super::output::{say, write_to};
use crate::report::{self, Report};
use crate::source::audit::Proof;

/// Files for the result; the text on the terminal comes in any case.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Results")]
pub struct ResultOptions {
    /// Write the result as JSON to this file; - is standard output, in place of the text.
    #[arg(long, value_name = "OUT")]
    pub json: Option<String>,
    /// Write a self-contained page with plots to this file.
    #[arg(long, value_name = "OUT.html")]
    pub report: Option<String>,
    /// Write the plots to this file as a bitmap.
    #[arg(long, value_name = "OUT.png")]
    pub png: Option<String>,
}

impl ResultOptions {
    /// Whether anything but text is asked for.
    pub fn any(&self) -> bool {
        self.json.is_some() || self.report.is_some() || self.png.is_some()
    }

    /// The files that were asked for.
    pub fn outputs(&self) -> [Option<&str>; 3] {
        [&self.json, &self.report, &self.png].map(Option::as_deref)
    }

    /// Writes the files that were asked for, and the text.
    ///
    /// # Errors
    /// If a file cannot be written; the message names it.
    pub fn write(&self, result: &impl Report) -> anyhow::Result<()> {
        if let Some(path) = &self.json {
            write_to(path, |mut output| report::json::write(result, &mut output))?;
        }
        if let Some(path) = &self.report {
            write_to(path, |output| output.write_all(result.page().as_bytes()))?;
        }
        if let Some(path) = &self.png {
            let bitmap = result.bitmap()?;
            write_to(path, |output| output.write_all(&bitmap))?;
        }
        self.say(&result.text())
    }

    /// Shows text on standard output, unless the result itself goes there.
    ///
    /// # Errors
    /// If standard output cannot be written.
    pub fn say(&self, text: &str) -> anyhow::Result<()> {
        if self.json.as_deref() != Some("-") {
            say(text)?;
        }
        Ok(())
    }

    /// Says how far the board's own bins agree with those of the host, under the table.
    ///
    /// # Errors
    /// If standard output cannot be written.
    pub fn write_proof(&self, proof: Option<Proof>) -> anyhow::Result<()> {
        proof.map_or(Ok(()), |proof| self.say(&format!("{proof}\n")))
    }
}
