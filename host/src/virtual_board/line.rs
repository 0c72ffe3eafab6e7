//! The line between the board's thread and the host: parcels one way, what the host wrote the other.

use std::sync::mpsc::{Receiver, Sender};
use std::time::Duration;

use inm_protocol::FRAME_END;

/// What a parcel counts as for who waits for the board: the time of one at rest.
pub(super) const PARCEL: Duration = Duration::from_millis(50);

/// Parcels that the board is ahead of the host. Enough that neither thread waits for the other
/// where both are as fast; a command waits 0.4 s of a board at rest, well inside the patience for
/// its reply where the board keeps real time.
const AHEAD: usize = 8;

/// What leaves the board at once.
#[derive(Debug, Default)]
pub(super) struct Parcel {
    /// What has left its transmitter, in whole bytes.
    pub bytes: Vec<u8>,
    /// When it left, by the board's virtual time since it was switched on, picoseconds.
    pub at_ps: u64,
    /// Ends of the frames among the bytes, and when each had left.
    pub frames: Vec<(usize, u64)>,
}

impl Parcel {
    /// Takes a byte that has left by virtual time `now_ps`.
    pub(super) fn push(&mut self, byte: u8, now_ps: u64) {
        self.bytes.push(byte);
        if byte == FRAME_END {
            self.frames.push((self.bytes.len(), now_ps));
        }
    }
}

/// The board's end of the line between the threads.
pub(super) struct Line {
    to_host: Sender<Parcel>,
    /// What the host wrote, once for every parcel that it asked for.
    from_host: Receiver<Vec<u8>>,
    /// Parcels that the host has not asked for, up to [`AHEAD`].
    ahead: usize,
}

impl Line {
    /// The end of a line on which nothing has been said.
    pub(super) fn new(to_host: Sender<Parcel>, from_host: Receiver<Vec<u8>>) -> Self {
        Self {
            to_host,
            from_host,
            ahead: 0,
        }
    }

    /// Sends a parcel; what the host wrote, or `None` if it is gone.
    pub(super) fn exchange(&mut self, parcel: Parcel) -> Option<Vec<u8>> {
        self.to_host.send(parcel).ok()?;
        if self.ahead < AHEAD {
            self.ahead += 1;
            return Some(Vec::new());
        }
        self.from_host.recv().ok()
    }
}
