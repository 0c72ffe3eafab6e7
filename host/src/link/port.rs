//! Where the board's bytes come from.

use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

use super::LinkError;

/// A byte stream to and from a board.
///
/// `read` waits a short while for something to arrive and returns
/// [`io::ErrorKind::TimedOut`] if nothing did; any other error means that the port is gone.
pub trait Port: Read + Write + Send {}

impl<T: Read + Write + Send> Port for T {}

/// Opens a port, and opens it again after it has vanished.
pub trait Connect: Send {
    /// Name of the port, for people.
    fn name(&self) -> String;

    /// Whether what is behind the port waits for who reads it, so that nothing is lost however slow
    /// that is. No UART does.
    fn waits(&self) -> bool {
        false
    }

    /// Opens the port.
    ///
    /// # Errors
    /// [`LinkError::Open`].
    fn open(&mut self) -> Result<Box<dyn Port>, LinkError>;
}

/// How long one read waits for a byte.
pub(super) const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// Nothing arrived in time, which is no fault.
pub(super) fn is_wait(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
    )
}

/// A serial port of this machine.
#[derive(Debug, Clone)]
pub struct SerialConnect {
    /// Path or name, such as `/dev/ttyUSB0` or `COM3`.
    pub path: String,
    /// Bit/s.
    pub baud: u32,
}

impl Connect for SerialConnect {
    fn name(&self) -> String {
        self.path.clone()
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        serialport::new(&self.path, self.baud)
            .timeout(READ_TIMEOUT)
            .open()
            .map(|port| Box::new(Serial(port)) as Box<dyn Port>)
            .map_err(|source| LinkError::Open {
                port: self.path.clone(),
                available: serialport::available_ports()
                    .unwrap_or_default()
                    .into_iter()
                    .map(|port| port.port_name)
                    .collect(),
                source,
            })
    }
}

/// A [`serialport::SerialPort`] whose end of file is an error: a terminal has no end, so a
/// read of nothing means that the other side has hung up.
struct Serial(Box<dyn serialport::SerialPort>);

impl Read for Serial {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buf) {
            Ok(0) => Err(io::ErrorKind::BrokenPipe.into()),
            other => other,
        }
    }
}

impl Write for Serial {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        self.0.write(buf)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
