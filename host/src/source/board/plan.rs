//! What a recording is to be, and its end on demand.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use inm_protocol::{SensorRange, Settings};

use crate::link::Patience;

/// How a board is to record.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    /// Settings to ask for; `None` leaves the board's.
    pub settings: Option<Settings>,
    /// Range of the accelerometers to select; `None` leaves the board's.
    pub range: Option<SensorRange>,
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
pub struct Stop {
    requested: Arc<AtomicBool>,
    /// What ends all, and this with it.
    outer: Option<Arc<Self>>,
}

impl Stop {
    /// One of a single recording among several: it ends with `self`, and `self` not with it.
    #[must_use]
    pub fn within(&self) -> Self {
        Self {
            requested: Arc::default(),
            outer: Some(Arc::new(self.clone())),
        }
    }

    /// Asks for the end.
    pub fn request(&self) {
        self.requested.store(true, Ordering::Relaxed);
    }

    /// Whether the end was asked for.
    pub fn requested(&self) -> bool {
        self.requested.load(Ordering::Relaxed)
            || self.outer.as_ref().is_some_and(|outer| outer.requested())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_all_ends_each_and_the_end_of_one_no_other() {
        let all = Stop::default();
        let [one, other] = [all.within(), all.within()];
        one.clone().request();
        assert!(one.requested() && !other.requested() && !all.requested());
        all.request();
        assert!(other.requested());
    }
}
