//! The host's end of a virtual board's link: a port that asks for each parcel of bytes.

use std::io::{self, Read, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use super::line::{PARCEL, Parcel};
use crate::link::{Arrival, Clock};

/// How long one read waits for the board's thread.
const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// The host's end of a virtual board's link.
pub(super) struct VirtualPort {
    from_board: Receiver<Parcel>,
    to_board: Sender<Vec<u8>>,
    /// What the host wrote since it last asked for a parcel.
    written: Vec<u8>,
    /// The next parcel was asked for and has not come yet.
    asked: bool,
    /// What was read last, and up to which byte.
    parcel: Parcel,
    at: usize,
    clock: Clock,
    time: HostTime,
}

/// What a clock beside the board says while the board lives.
struct HostTime {
    /// What it said when this life of the board began.
    begun: Duration,
    /// When the last parcel left, picoseconds of this life's virtual time.
    at_ps: u64,
    /// Seconds of virtual time, which is the converters' own, in a true one.
    pace: f64,
}

impl HostTime {
    /// The next parcel left at this instant of virtual time. A board that has restarted counts from 0 again, and
    /// time goes on.
    fn pass(&mut self, at_ps: u64) {
        if at_ps < self.at_ps {
            self.begun = self.at(self.at_ps);
        }
        self.at_ps = at_ps;
    }

    /// The time at an instant of this life.
    fn at(&self, at_ps: u64) -> Duration {
        self.begun + Duration::from_secs_f64(at_ps as f64 * 1e-12 / self.pace)
    }
}

impl VirtualPort {
    /// The end of a line on which nothing has been said, with the host's clock, and how many seconds of virtual
    /// time pass in one of it.
    pub(super) fn new(
        from_board: Receiver<Parcel>,
        to_board: Sender<Vec<u8>>,
        clock: Clock,
        pace: f64,
    ) -> Self {
        let time = HostTime {
            begun: clock.arrival().all,
            at_ps: 0,
            pace,
        };
        Self {
            clock,
            time,
            from_board,
            to_board,
            written: Vec::new(),
            asked: false,
            parcel: Parcel::default(),
            at: 0,
        }
    }

    /// Tells when the next `len` bytes of the parcel had arrived.
    fn tell_arrival(&mut self, len: usize) {
        let read = self.at..self.at + len;
        let ends = self.parcel.frames.iter();
        let ends = ends.filter(|(end, _)| read.contains(&(end - 1)));
        let frames = ends.map(|&(end, at_ps)| (end - read.start, self.time.at(at_ps)));
        let frames = frames.collect();
        let all = self.time.at(self.parcel.at_ps);
        self.clock.arrived(Arrival { all, frames });
    }

    /// The next parcel, which may be empty.
    fn next_parcel(&mut self, patience: Duration) -> io::Result<Parcel> {
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
        self.time.pass(parcel.at_ps);
        Ok(parcel)
    }
}

impl Read for VirtualPort {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let deadline = Instant::now() + READ_TIMEOUT;
        while self.at == self.parcel.bytes.len() {
            let left = deadline.saturating_duration_since(Instant::now());
            self.parcel = self.next_parcel(left)?;
            self.at = 0;
        }
        let rest = &self.parcel.bytes[self.at..];
        let len = rest.len().min(buf.len());
        buf[..len].copy_from_slice(&rest[..len]);
        self.tell_arrival(len);
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
