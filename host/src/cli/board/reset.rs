//! `inm board reset`: restart a board.

use std::process::ExitCode;

use clap::Args;

use super::which::Which;
use super::{JsonOption, status};
use crate::inspect::reset::reset;
use crate::source::SourceError;

/// Arguments of `inm board reset`.
#[derive(Debug, Args)]
pub struct ResetCommand {
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    json: JsonOption,
}

impl ResetCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the port or the board says; that it did not come back.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        self.json.check()?;
        let mut found = self.which.find()?;
        let restarted = reset(found.port, &mut found.session).map_err(SourceError::from)?;
        let doubt = if restarted.as_told {
            ""
        } else {
            "; that is not what it was told"
        };
        let text = format!(
            "{}: board {} answers again after {:.1} s; it started: {}{doubt}\n",
            restarted.port, restarted.serial, restarted.back_after_s, restarted.restart_words
        );
        self.json.write(&restarted, &text)?;
        Ok(status(restarted.as_told))
    }
}
