//! Where the board's bytes come from.

use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

use super::{Clock, LinkError};

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

    /// The time by which waits for the board are measured. Where the board runs in a time of its own, a
    /// busy machine must not make it look slow.
    fn clock(&self) -> Clock {
        Clock::of_the_wall()
    }

    /// Opens the port.
    ///
    /// # Errors
    /// [`LinkError::Open`].
    fn open(&mut self) -> Result<Box<dyn Port>, LinkError>;

    /// What was opened last is not what was looked for: the next time, look elsewhere first.
    fn reject(&mut self) {}
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
