//! Sources that can say how a recording is going.

use std::path::Path;

use super::Snapshot;
use crate::source::Source;
use crate::source::board::BoardSource;
use crate::source::capture::CaptureSource;

/// A source whose link, losses and board can be shown while it runs.
pub trait Observed: Source {
    /// The state of the stream now; the table and the news are the view's own.
    fn snapshot(&self) -> Snapshot;
}

impl Observed for BoardSource {
    fn snapshot(&self) -> Snapshot {
        let signal = self.signal();
        Snapshot {
            source: signal.name.clone(),
            capture: self.capture_path().map(Path::to_owned),
            settings: Some(self.header().settings),
            rate_hz: signal.rate_hz,
            samples: self.next_index(),
            expected: self.expected_len(),
            bytes: self.captured_bytes(),
            losses: self.losses(),
            damaged: self.damaged().0,
            health: self.status().health,
            proof: self.proof(),
            ..Snapshot::default()
        }
    }
}

impl Observed for CaptureSource {
    fn snapshot(&self) -> Snapshot {
        let signal = self.signal();
        Snapshot {
            source: signal.name.clone(),
            rate_hz: signal.rate_hz,
            samples: self.next_index(),
            losses: self.losses(),
            damaged: self.damaged().0,
            health: self.status().health,
            proof: self.proof(),
            ..Snapshot::default()
        }
    }
}
