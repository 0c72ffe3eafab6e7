//! What a recording is to be, and its end on demand.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use inm_protocol::Settings;

use crate::link::Patience;

/// How a board is to record.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    /// Settings to ask for; `None` leaves the board's.
    pub settings: Option<Settings>,
    /// Samples an axis after which to stop; `None` runs until told to.
    pub samples: Option<u64>,
    /// Waits for replies.
    pub patience: Patience,
    /// How long to wait for a board that went away, fell silent or stopped; `None` gives up at once.
    pub reconnect: Option<Duration>,
}

/// Ends a recording from another thread or a signal handler: the board is told to stop, what
/// is under way is drained, the capture gets its end note.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks for the end.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the end was asked for.
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
