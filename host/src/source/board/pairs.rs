//! Both clocks at once: a note in the capture for each health record that has arrived.

use std::time::Duration;

use inm_protocol::Note;

use super::resume::now_ms;
use crate::link::Arrival;
use crate::source::frames::Status;

/// What the host's clock said when health records had arrived.
pub(super) struct Pairs {
    /// The host's clock when the recording began.
    begun: Duration,
    /// Stamp of the last record that was looked at, or passed over.
    stamp: Option<u64>,
    /// What waits for the end of a frame: of two, the later.
    waiting: Option<Note>,
}

impl Pairs {
    /// A recording that begins when the host's clock says `now`. When what is known by then had arrived was not
    /// looked at.
    pub(super) fn new(now: Duration, status: &Status) -> Self {
        let mut pairs = Self {
            begun: now,
            stamp: None,
            waiting: None,
        };
        pairs.pass_over(status);
        pairs
    }

    /// Looks whether a health record is among what has just been taken in, the first `bytes` of a read.
    pub(super) fn look(&mut self, status: &Status, arrival: &Arrival, bytes: usize) {
        let before = self.stamp;
        self.pass_over(status);
        if let Some(stamp) = self.stamp.filter(|_| self.stamp != before) {
            let at = arrival.of(bytes.saturating_sub(status.behind_health));
            self.waiting = Some(Note::Clock {
                unix_ms: now_ms(),
                stamp,
                host_us: at.saturating_sub(self.begun).as_micros() as u64,
            });
        }
    }

    /// What was heard while something else was waited for came at no time that is known.
    pub(super) fn pass_over(&mut self, status: &Status) {
        self.stamp = status.health.map(|health| health.stamp);
    }

    /// What there is to note.
    pub(super) fn take(&mut self) -> Option<Note> {
        self.waiting.take()
    }
}
