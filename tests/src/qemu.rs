//! The firmware's image in QEMU, reached through a serial port of this machine.

use std::ffi::OsString;
use std::io::{self, BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use inm_host::internals::link::{Patience, SerialConnect};

/// Environment variable that names the image for QEMU; `cargo xtask test` sets it.
pub const IMAGE_VARIABLE: &str = "INM_QEMU_IMAGE";

/// Environment variable that names QEMU's program, where it is not on the path; `cargo xtask test` sets it.
const PROGRAM_VARIABLE: &str = "INM_QEMU";

/// Nanoseconds of an instruction, as a power of two: at 4 ns the three emulated converters
/// keep up with 4000/s. On a slower core bench time would only pass more slowly.
const SHIFT: u32 = 2;

/// QEMU drops what the board says until it notices, by a look once a second, that somebody
/// listens; and the machine may be busy with other tests.
pub const PATIENCE: Patience = Patience {
    wait: Duration::from_secs(3),
    tries: 20,
    silence: Duration::from_secs(10),
};

/// Environment variable that names the image that fills its stack; `cargo xtask test` sets it.
pub const OVERFLOW_VARIABLE: &str = "INM_QEMU_OVERFLOW";

/// QEMU's program.
#[must_use]
pub fn program() -> OsString {
    std::env::var_os(PROGRAM_VARIABLE).unwrap_or_else(|| "qemu-system-arm".into())
}

/// A virtual machine; killed when dropped.
pub struct Qemu {
    child: Child,
    port: String,
}

impl Qemu {
    /// Starts the image that [`IMAGE_VARIABLE`] names.
    ///
    /// # Errors
    /// No image, no QEMU, or a QEMU that does not say where its serial port is.
    pub fn start() -> io::Result<Self> {
        let image = std::env::var_os(IMAGE_VARIABLE).ok_or_else(|| {
            io::Error::other(format!(
                "{IMAGE_VARIABLE} is not set; run: cargo xtask test"
            ))
        })?;
        let mut qemu = Self {
            child: launch(&image)?,
            port: String::new(),
        };
        let output = qemu.child.stdout.take().ok_or(io::ErrorKind::BrokenPipe)?;
        let mut said = String::new();
        // "char device redirected to /dev/pts/3 (label serial0)"
        BufReader::new(output).read_line(&mut said)?;
        let port = said
            .split_whitespace()
            .find(|word| word.starts_with("/dev/"));
        qemu.port = port
            .ok_or_else(|| io::Error::other(format!("QEMU names no port, but says {said:?}")))?
            .to_owned();
        Ok(qemu)
    }

    /// The way to its serial port.
    pub fn connect(&self) -> SerialConnect {
        SerialConnect::new(self.port.as_str(), 921_600)
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn launch(image: &OsString) -> io::Result<Child> {
    let program = program();
    Command::new(&program)
        .args([
            "-M",
            "netduinoplus2",
            "-nographic",
            "-monitor",
            "none",
            "-serial",
            "pty",
        ])
        .args(["-icount", &format!("shift={SHIFT},sleep=off"), "-kernel"])
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| io::Error::other(format!("{}: {error}", program.display())))
}
