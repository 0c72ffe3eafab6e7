//! A terminal that is stopped most of the time, as by Ctrl-S or a window that hangs.

use std::fs::OpenOptions;
use std::io::{self, Read};
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use serialport::{SerialPort, TTYPort};

/// How long nothing is read, and for how long something is then: a terminal holds 4 kB, which a picture
/// twice a second fills in a second.
const STOPPED: Duration = Duration::from_secs(8);
const READ: Duration = Duration::from_millis(300);

/// Bytes that are kept: a picture and the message behind it.
const KEPT: usize = 8192;

/// The half that stays here.
pub struct Terminal {
    ended: Arc<AtomicBool>,
    reader: JoinHandle<Vec<u8>>,
}

/// The terminal, and what a program writes to.
pub fn stopped_now_and_then() -> io::Result<(Terminal, Stdio)> {
    let (mut near, far) = TTYPort::pair()?;
    near.set_timeout(Duration::from_millis(10))?;
    let path = far.name().ok_or(io::ErrorKind::NotFound)?;
    let screen = OpenOptions::new().write(true).open(path)?;
    let ended = Arc::new(AtomicBool::new(false));
    let end = Arc::clone(&ended);
    let reader = thread::spawn(move || {
        let _far = far;
        let (mut buf, mut shown) = ([0; 4096], Vec::new());
        while !end.load(Ordering::Relaxed) {
            let until = std::time::Instant::now() + READ;
            while std::time::Instant::now() < until {
                let length = near.read(&mut buf).unwrap_or(0);
                shown.extend_from_slice(&buf[..length]);
            }
            shown.drain(..shown.len().saturating_sub(KEPT));
            let until = std::time::Instant::now() + STOPPED;
            while std::time::Instant::now() < until && !end.load(Ordering::Relaxed) {
                thread::sleep(Duration::from_millis(50));
            }
        }
        while let Ok(length) = near.read(&mut buf) {
            shown.extend_from_slice(&buf[..length]);
        }
        shown
    });
    Ok((Terminal { ended, reader }, screen.into()))
}

impl Terminal {
    /// What it showed last.
    pub fn shown(self) -> String {
        self.ended.store(true, Ordering::Relaxed);
        let shown = self.reader.join().unwrap_or_default();
        String::from_utf8_lossy(&shown).into_owned()
    }
}
