//! The program with a limit of time.

use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// How many times the limit it may last on a busy machine.
const WAITING: u32 = 10;

/// Ticks of a second in `/proc` (proc(5); 100 on every Linux).
const TICKS: f64 = 100.0;

/// How it ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// By itself; the status, none for a signal, and what it said on standard error.
    Ended(Option<i32>, String),
    /// It had to be ended.
    Late,
}

/// Processor time of a running process; `None` where there is no `/proc`.
fn processor_time(process: u32) -> Option<Duration> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // Behind the name in brackets: state, then the 14th and 15th field, own time and the kernel's.
    let fields = stat.rsplit_once(')')?.1;
    let ticks = fields.split_whitespace().skip(11).take(2);
    let ticks = ticks.map(|field| field.parse::<u32>().ok());
    let ticks = ticks.sum::<Option<u32>>()?;
    Some(Duration::from_secs_f64(f64::from(ticks) / TICKS))
}

/// Runs `inm` with these arguments in `folder` for at most `limit` of processor time.
///
/// # Errors
/// If it does not start or its words cannot be kept.
pub fn run<A: AsRef<OsStr>>(
    inm: &Path,
    arguments: impl IntoIterator<Item = A>,
    folder: &Path,
    limit: Duration,
) -> io::Result<End> {
    // A file, since a full pipe would stop it for good.
    let errors = folder.join("stderr.txt");
    let mut child = Command::new(inm)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(&errors)?)
        .spawn()?;
    let start = Instant::now();
    let mut wait = Duration::from_millis(2);
    loop {
        if let Some(status) = child.try_wait()? {
            let said = std::fs::read(&errors)?;
            let said = String::from_utf8_lossy(&said).into_owned();
            return Ok(End::Ended(status.code(), said));
        }
        // What it took of the processors says more on a machine that is busy; what waits for ever takes
        // nothing.
        let elapsed = start.elapsed();
        let taken = processor_time(child.id()).unwrap_or(elapsed);
        if taken > limit || elapsed > WAITING * limit {
            child.kill()?;
            child.wait()?;
            return Ok(End::Late);
        }
        thread::sleep(wait);
        wait = (2 * wait).min(Duration::from_millis(50));
    }
}
