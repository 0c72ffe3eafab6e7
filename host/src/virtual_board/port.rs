//! The host's end of a virtual board's link: a port that asks for each parcel of bytes.

use std::io::{self, Read, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use super::line::PARCEL;
use crate::link::Clock;

/// How long one read waits for the board's thread.
const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// The host's end of a virtual board's link.
pub(super) struct VirtualPort {
    from_board: Receiver<Vec<u8>>,
    to_board: Sender<Vec<u8>>,
    /// What the host wrote since it last asked for a parcel.
    written: Vec<u8>,
    /// The next parcel was asked for and has not come yet.
    asked: bool,
    parcel: Vec<u8>,
    at: usize,
    clock: Clock,
}

impl VirtualPort {
    /// The end of a line on which nothing has been said.
    pub(super) fn new(
        from_board: Receiver<Vec<u8>>,
        to_board: Sender<Vec<u8>>,
        clock: Clock,
    ) -> Self {
        Self {
            clock,
            from_board,
            to_board,
            written: Vec::new(),
            asked: false,
            parcel: Vec::new(),
            at: 0,
        }
    }

    /// The next parcel, which may be empty.
    fn next_parcel(&mut self, patience: Duration) -> io::Result<Vec<u8>> {
        if !self.asked {
            let written = std::mem::take(&mut self.written);
            self.to_board
                .send(written)
                .map_err(|_| io::ErrorKind::BrokenPipe)?;
            self.asked = true;
        }
        let parcel = self
            .from_board
            .recv_timeout(patience)
            .map_err(|error| match error {
                RecvTimeoutError::Timeout => io::ErrorKind::TimedOut,
                RecvTimeoutError::Disconnected => io::ErrorKind::BrokenPipe,
            })?;
        self.asked = false;
        self.clock.pass(PARCEL);
        Ok(parcel)
    }
}

impl Read for VirtualPort {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let deadline = Instant::now() + READ_TIMEOUT;
        while self.at == self.parcel.len() {
            let left = deadline.saturating_duration_since(Instant::now());
            self.parcel = self.next_parcel(left)?;
            self.at = 0;
        }
        let rest = &self.parcel[self.at..];
        let len = rest.len().min(buf.len());
        buf[..len].copy_from_slice(&rest[..len]);
        self.at += len;
        Ok(len)
    }
}

impl Write for VirtualPort {
    /// Leaves when the host next asks for a parcel.
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        self.written.extend_from_slice(buf);
        Ok(buf.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
