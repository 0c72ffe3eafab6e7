//! A night at the bench in less time: `inm live` records a virtual board behind a serial port of this
//! machine, to which everything happens, and each sample is compared with the converters' own words.
//!
//! ```text
//!   far_end   the board, its converters' faults, restarts, ports that vanish   --pty-->  inm live
//!   terminal  its screen, stopped most of the time                             <--pty--
//!   truth     the words that each converter made, on disk
//!   check     the capture against them: right, flagged, or known to be missing
//!   memory    what the process holds, through the night
//! ```

mod check;
mod far_end;
mod kills;
mod memory;
mod terminal;
mod truth;

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

pub use check::Account;
pub use far_end::{Happened, Weather};
pub use kills::{Killed, conversions, kill};
pub use memory::Memory;

/// What came of a night.
#[derive(Debug)]
pub struct Night {
    /// What happened to the board.
    pub happened: Happened,
    /// What the capture says of it, an axis each.
    pub axes: [Account; 3],
    /// What the program held.
    pub memory: Memory,
    /// Exit status of the program.
    pub status: Option<i32>,
    /// What its terminal showed last.
    pub shown: String,
}

/// Waits for the port that is its first argument, and becomes the program that follows.
const WHEN_PLUGGED: &str = "while [ ! -e \"$0\" ]; do sleep 0.05; done; exec \"$@\"";

/// Records `hours` of a board at 4000/s with the program `inm`, and compares.
///
/// # Errors
/// Files, ports or the program cannot be had; the capture cannot be read.
pub fn night(inm: &Path, hours: f64, seed: u64, weather: Weather) -> io::Result<Night> {
    let folder = tempfile::tempdir()?;
    let port = folder.path().join("port");
    let capture = folder.path().join("night.inmcap");
    let (terminal, screen) = terminal::stopped_now_and_then()?;
    // It is there before the port: else it would inherit the far end, and hold it open when the cable is out.
    let mut live = Command::new("sh")
        .args(["-c", WHEN_PLUGGED])
        .arg(&port)
        .arg(inm)
        .args(["live", "--rate", "4000", "--source"])
        .arg(&port)
        .args(["--duration", &(hours * 3600.0).to_string(), "-o"])
        .arg(&capture)
        .stderr(screen)
        .stdout(Stdio::null())
        .spawn()?;
    let far_end = far_end::FarEnd::power_on(&port, folder.path(), seed, weather)?;
    let memory = Memory::of(&mut live)?;
    let status = live.wait()?.code();
    let shown = terminal.shown();
    let happened = far_end.power_off()?;
    let axes = check::compare(&capture, folder.path())?;
    Ok(Night {
        happened,
        axes,
        memory,
        status,
        shown,
    })
}
