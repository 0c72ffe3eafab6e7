//! The command line: one file per subcommand.
//!
//! Exit status: 0 done; 1 `diagnose` left something unexplained, `record` or `live` lost samples, or a
//! board is not as it should be (`board selftest`, `board reset`, `calibrate`); 2 bad usage or input, with a message that names the place and the remedy.

pub mod analyze;
pub mod board;
pub mod calibrate;
pub mod column;
pub mod demo;
pub mod diagnose;
pub mod export;
#[cfg(feature = "flash")]
pub mod flash;
pub mod input;
pub mod interrupt;
pub mod live;
pub mod output;
pub mod record;
pub mod recording;
pub mod replay;
pub mod results;
pub mod simulate;

use std::io::Write;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use crate::plain::on_a_line;

/// Exit status of bad usage or input; clap uses the same.
const BAD_INPUT: u8 = 2;

/// Noise bench for inertial accelerometers.
#[derive(Debug, Parser)]
#[command(name = "inm", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The whole chain without hardware: virtual board, capture, noise table, report.
    Demo(demo::DemoCommand),
    /// Record a board into a capture file.
    Record(record::RecordCommand),
    /// Record a board and watch its Allan deviation grow.
    Live(live::LiveCommand),
    /// Allan deviation and noise coefficients of a record.
    Analyze(analyze::Analyze),
    /// What the simulation gets wrong about a record, why, and what the extended model gains.
    Diagnose(diagnose::DiagnoseCommand),
    /// Data from a noise model.
    Simulate(simulate::Simulate),
    /// A noise model in the format of another program.
    Export(export::Export),
    /// Send a capture down the path that live data take.
    Replay(replay::ReplayCommand),
    /// Which boards there are, what they are, whether they measure, what goes wrong on them.
    Board(board::BoardCommand),
    /// Scale, misalignment and zero of a board's accelerometers from gravity in many positions.
    Calibrate(calibrate::CalibrateCommand),
    /// Program the board through a debug probe.
    #[cfg(feature = "flash")]
    Flash(flash::FlashCommand),
}

/// The command line as it is read: its commands and their options.
pub fn described() -> clap::Command {
    Arguments::command()
}

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Demo(command) => command.run(),
        Command::Record(command) => return finish(command.run()),
        Command::Live(command) => return finish(command.run()),
        Command::Analyze(command) => command.run(),
        Command::Diagnose(command) => return finish(command.run()),
        Command::Simulate(command) => command.run(),
        Command::Export(command) => command.run(),
        Command::Replay(command) => command.run(),
        Command::Board(command) => return finish(command.run()),
        Command::Calibrate(command) => return finish(command.run()),
        #[cfg(feature = "flash")]
        Command::Flash(command) => command.run(),
    };
    finish(result.map(|()| ExitCode::SUCCESS))
}

/// Status of the process for the outcome of a subcommand.
fn finish(result: anyhow::Result<ExitCode>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // The whole chain of causes on one line.
            let message = format!("inm: {error:#}");
            // Where nobody listens, the exit status says it.
            let _ = writeln!(std::io::stderr(), "{}", on_a_line(&message));
            ExitCode::from(BAD_INPUT)
        }
    }
}

/// Whether the reader of our output went away, as `head` does: no error to speak of.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|error| error.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
