//! A recording that is killed, without a warning and at any moment: what had been written is there, and is
//! read back as the converters made it.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use inm_protocol::{AXES, Decoder, ToHost};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::WHEN_PLUGGED;
use super::check::{Account, compare};
use super::far_end::{FarEnd, Weather};

/// Nothing happens to the board; its time runs so fast that the disk is written to all the time.
const CALM: Weather = Weather {
    speed: 20.0,
    cable_s: 1e9,
    power_s: 1e9,
    slips: false,
};

/// Longest life of a program, milliseconds: its start, which takes a fifth of that, and two times that
/// the disk is asked to keep what it has.
const LONGEST_MS: u64 = 2500;

/// What was left of one recording.
#[derive(Debug)]
pub struct Killed {
    /// What was killed: `record` or `live`.
    pub command: &'static str,
    /// Bytes in the file right ahead of the kill.
    pub written: u64,
    /// Those of them that are not there any more, or changed.
    pub lost: u64,
    /// Conversions in the whole frames of the file, counted without the host's reader.
    pub conversions: u64,
    /// What the host reads of it; `None` where no conversion is in it.
    pub axes: Option<[Account; AXES]>,
}

impl Killed {
    /// Whether nothing was lost, and everything is read as it was made.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let whole = |axis: &Account| {
            axis.wrong == 0
                && axis.missing == 0
                && axis.end == self.conversions
                && axis.right + axis.flagged == axis.end
        };
        self.lost == 0 && self.axes.iter().flatten().all(whole)
    }
}

/// Has `inm` record a board behind a serial port, and kills it (SIGKILL) at a moment that follows from
/// `seed`.
///
/// # Errors
/// Files, ports or the program cannot be had; what it has recorded cannot be read.
pub fn kill(inm: &Path, seed: u64) -> io::Result<Killed> {
    let mut random = Pcg64::seed_from_u64(seed);
    let command = ["record", "live"][random.random_range(0..2)];
    let folder = tempfile::tempdir()?;
    let [port, capture] = ["port", "run.inmcap"].map(|name| folder.path().join(name));
    let mut program = Command::new("sh")
        .args(["-c", WHEN_PLUGGED])
        .arg(&port)
        .arg(inm)
        .args([command, "--rate", "4000", "--source"])
        .arg(&port)
        .arg("-o")
        .arg(&capture)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()?;
    let far_end = FarEnd::power_on(&port, folder.path(), random.random(), CALM)?;
    thread::sleep(Duration::from_millis(random.random_range(0..LONGEST_MS)));
    let written = there(&capture)?;
    program.kill()?;
    let status = program.wait()?;
    far_end.power_off()?;
    if status.code().is_some() {
        return Err(io::Error::other(format!(
            "{command} ended by itself: {status}"
        )));
    }
    let kept = there(&capture)?;
    let same = written.iter().zip(&kept).take_while(|(a, b)| a == b);
    let lost = written.len() - same.count();
    let conversions = conversions(&kept);
    let axes = (conversions > 0).then(|| compare(&capture, folder.path()));
    Ok(Killed {
        command,
        written: written.len() as u64,
        lost: lost as u64,
        conversions,
        axes: axes.transpose()?,
    })
}

/// What the file holds; nothing where there is none yet.
fn there(file: &Path) -> io::Result<Vec<u8>> {
    match fs::read(file) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        read => read,
    }
}

/// Conversions in the whole frames of a capture, behind the two lines of its header, counted without the host's reader.
pub fn conversions(capture: &[u8]) -> u64 {
    let mut lines = capture.splitn(3, |&byte| byte == b'\n');
    let mut frames = lines.nth(2).unwrap_or_default();
    let mut decoder: Decoder = Decoder::default();
    let mut count = 0;
    while let Some(message) = decoder.next(&mut frames) {
        if let Ok(ToHost::Samples(batch)) = message {
            count += batch.codes.len() as u64;
        }
    }
    count
}
