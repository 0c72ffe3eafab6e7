//! `inm board`: which boards there are, what they are, whether they measure, what goes wrong on them,
//! and a new program for one.

mod info;
mod log;
mod ports;
#[cfg(feature = "flash")]
mod probed;
mod reset;
mod selftest;
mod sink;
#[cfg(feature = "image")]
mod update;
pub(super) mod which;

use std::process::ExitCode;

use clap::{Args, Subcommand};
use serde::Serialize;

use super::output::{self, say, write_to};
use crate::report;

/// Arguments of `inm board`.
#[derive(Debug, Args)]
pub struct BoardCommand {
    #[command(subcommand)]
    question: Question,
}

#[derive(Debug, Subcommand)]
enum Question {
    /// Serial ports of this machine, who may open them, and (if asked) which boards are there.
    Ports(ports::Ports),
    /// What a board is: identity, versions, settings, registers, calibration, restart, state.
    Info(info::InfoCommand),
    /// Whether a board measures: self-test step, output at rest, noise, supply, clock. Stops its stream.
    Selftest(selftest::Selftest),
    /// Bring a new program onto a board over its serial line, and wait until it answers.
    #[cfg(feature = "image")]
    Update(update::UpdateCommand),
    /// Restart a board, and wait until it is back.
    Reset(reset::ResetCommand),
    /// What goes wrong on a board, in words, as it says it.
    Log(log::LogCommand),
}

impl BoardCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the port or the board says.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self.question {
            Question::Ports(command) => command.run(),
            Question::Info(command) => command.run(),
            Question::Selftest(command) => command.run(),
            #[cfg(feature = "image")]
            Question::Update(command) => command.run(),
            Question::Reset(command) => command.run(),
            Question::Log(command) => command.run(),
        }
    }
}

/// Where a result goes besides the terminal.
#[derive(Debug, Clone, Args)]
pub(super) struct JsonOption {
    /// Write the result as JSON to this file; - is standard output, in place of the text.
    #[arg(long, value_name = "OUT")]
    json: Option<String>,
}

impl JsonOption {
    /// Refuses a file that must not be replaced, before the board is asked for anything.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        output::check(&[self.json.as_deref()], &[])
    }

    /// Writes the file that was asked for, and the text.
    pub(super) fn write(&self, result: &impl Serialize, text: &str) -> anyhow::Result<()> {
        if let Some(path) = &self.json {
            write_to(path, |mut output| report::json::write(result, &mut output))?;
        }
        if self.json.as_deref() != Some("-") {
            say(text)?;
        }
        Ok(())
    }
}

/// Exit status of a board that was reached and is not as it should be.
const NOT_AS_IT_SHOULD_BE: u8 = 1;

/// Status of the process for a board that is as it should be, or not.
pub(super) fn status(good: bool) -> ExitCode {
    if good {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(NOT_AS_IT_SHOULD_BE)
    }
}
