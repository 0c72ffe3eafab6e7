//! The time by which a host waits for a board.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time as it passes for what is behind a port: waits for it are measured by this.
#[derive(Debug, Clone)]
pub struct Clock {
    begun: Instant,
    /// Milliseconds since then, where they do not pass by themselves.
    counted_ms: Option<Arc<AtomicU64>>,
}

impl Clock {
    /// The time of this machine.
    pub fn of_the_wall() -> Self {
        Self {
            begun: Instant::now(),
            counted_ms: None,
        }
    }

    /// Time that passes as [`Clock::pass`] says and stands still otherwise.
    pub fn counted() -> Self {
        Self {
            begun: Instant::now(),
            counted_ms: Some(Arc::default()),
        }
    }

    /// The time now.
    pub fn now(&self) -> Instant {
        match &self.counted_ms {
            None => Instant::now(),
            Some(counted) => self.begun + Duration::from_millis(counted.load(Ordering::Relaxed)),
        }
    }

    /// Lets time pass, to the millisecond, where it does not pass by itself.
    pub fn pass(&self, time: Duration) {
        if let Some(counted) = &self.counted_ms {
            counted.fetch_add(time.as_millis() as u64, Ordering::Relaxed);
        }
    }
}
