//! The time by which a host waits for a board.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time as it passes for what is behind a port: waits for it are measured by this.
#[derive(Debug, Clone)]
pub struct Clock {
    begun: Instant,
    /// Where time does not pass by itself.
    counted: Option<Arc<Counted>>,
}

/// What has passed since a clock was begun, where it does not pass by itself.
#[derive(Debug, Default)]
struct Counted {
    /// For who waits, milliseconds.
    patience_ms: AtomicU64,
    /// What a clock beside the board said when the bytes that were read last had arrived.
    arrival: Mutex<Arrival>,
}

/// When the bytes of a read had arrived, by a clock beside the board, since that was begun.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Arrival {
    /// When all of them had.
    pub all: Duration,
    /// Where that is known, the ends of the frames among them, bytes of the read, and when each had; ascending.
    pub frames: Vec<(usize, Duration)>,
}

impl Arrival {
    /// When the first `bytes` of the read had arrived, as well as that is known: never too early.
    pub fn of(&self, bytes: usize) -> Duration {
        let frame = self.frames.iter().find(|(end, _)| *end >= bytes);
        frame.map_or(self.all, |(_, at)| *at)
    }
}

impl Clock {
    /// The time of this machine.
    pub fn of_the_wall() -> Self {
        Self {
            begun: Instant::now(),
            counted: None,
        }
    }

    /// Time that passes as [`Clock::pass`] says and stands still otherwise.
    pub fn counted() -> Self {
        Self {
            begun: Instant::now(),
            counted: Some(Arc::default()),
        }
    }

    /// The time now.
    pub fn now(&self) -> Instant {
        match &self.counted {
            None => Instant::now(),
            Some(counted) => {
                self.begun + Duration::from_millis(counted.patience_ms.load(Ordering::Relaxed))
            }
        }
    }

    /// Lets time pass, to the millisecond, where it does not pass by itself.
    pub fn pass(&self, time: Duration) {
        if let Some(counted) = &self.counted {
            let ms = time.as_millis() as u64;
            counted.patience_ms.fetch_add(ms, Ordering::Relaxed);
        }
    }

    /// When what was read a moment ago had arrived, by a clock beside the board. It is none to wait by: where time
    /// is counted, the one of a board that is fast runs ahead of its host's patience.
    pub fn arrival(&self) -> Arrival {
        match &self.counted {
            None => Arrival {
                all: self.begun.elapsed(),
                frames: Vec::new(),
            },
            Some(counted) => {
                let arrival = counted.arrival.lock();
                arrival.unwrap_or_else(PoisonError::into_inner).clone()
            }
        }
    }

    /// What was read is handed out in parts: where its frames end in one of them is not known any more.
    pub(super) fn forget_frames(&self) {
        self.arrived(Arrival {
            frames: Vec::new(),
            ..self.arrival()
        });
    }

    /// Sets what [`Clock::arrival`] says, where time does not pass by itself.
    pub fn arrived(&self, arrival: Arrival) {
        if let Some(counted) = &self.counted {
            let mut last = counted
                .arrival
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            *last = arrival;
        }
    }
}
