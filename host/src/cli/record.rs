//! `inm record`: samples of a board into a capture.

use std::path::PathBuf;

use clap::Args;

use super::board::BoardArgs;
use super::watch::{Watched, watch};
use crate::live::Screen;
use crate::source::board::{BoardSource, Stop};

/// Record a board into a capture file.
#[derive(Debug, Args)]
pub struct RecordArgs {
    #[command(flatten)]
    pub board: BoardArgs,

    /// The capture to write; it must not exist.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// Runs `inm record`.
///
/// # Errors
/// What the board or the file says; what was recorded until then stays.
pub fn run(args: &RecordArgs, stop: &Stop) -> anyhow::Result<()> {
    let connect = args.board.connect(0.0);
    let source =
        BoardSource::start(connect, args.board.plan(), Some(&args.output), stop.clone())?;
    let mut watched = Watched::board(source, &args.output);
    let ended = watch(&mut watched, Screen::stderr(), None);
    // Said in either case: a recording that broke off is still a recording.
    eprintln!("{}", watched.summary());
    Ok(ended?)
}
