//! Why a stream broke off, put together from the host's notes and what the board said after it.

use inm_protocol::{Health, Note, Restart};
use jiff::Timestamp;

use crate::link::restarted;

/// A stream that broke off; the notes in the capture tell of it, so a replay says the same.
#[derive(Debug)]
pub struct Interruption {
    what: &'static str,
    port: bool,
    from_ms: i64,
    until_ms: Option<i64>,
    /// What the board had counted before.
    before: Clock,
    /// The board's counts went back: it has started anew since.
    restarted: bool,
    /// Why the board says it last started, asked since.
    cause: Option<Restart>,
}

/// Counts of a board that only its restart sets back.
#[derive(Debug, Clone, Copy, Default)]
pub struct Clock {
    /// Stamp of the last batch, ticks.
    batch: u64,
    /// Stamp of the last health record, ticks.
    health: u64,
    /// Frames sent, by the last health record.
    frames: u32,
}

impl Clock {
    /// Takes a health record.
    pub fn health(&mut self, health: &Health) {
        self.health = health.stamp;
        self.frames = health.link.frames_sent;
    }

    /// Takes the stamp of a batch.
    pub fn batch(&mut self, stamp: u64) {
        self.batch = stamp;
    }

    /// Whether one of the counts is behind what it was.
    fn is_behind(&self, before: &Self) -> bool {
        self.batch < before.batch || self.health < before.health || self.frames < before.frames
    }
}

impl Interruption {
    /// The interruption that a note tells of, if it begins one.
    pub fn new(note: &Note, before: Clock) -> Option<Self> {
        let (what, from_ms) = match *note {
            Note::PortLost { unix_ms } => ("the port went away", unix_ms),
            Note::BoardSilent { unix_ms } => ("the board fell silent", unix_ms),
            Note::BoardStopped { unix_ms } => ("the board stopped streaming", unix_ms),
            Note::Overrun { unix_ms, .. } => (
                "this machine did not write what arrived, and its queue was full",
                unix_ms,
            ),
            _ => return None,
        };
        Some(Self {
            what,
            port: matches!(note, Note::PortLost { .. }),
            from_ms,
            until_ms: match *note {
                Note::Overrun { until_ms, .. } => Some(until_ms),
                _ => None,
            },
            before,
            restarted: false,
            cause: None,
        })
    }

    /// Whether all that is known to have gone is the port.
    pub fn of_the_port(&self) -> bool {
        self.port
    }

    /// The stream, or the way to it, was back at this time.
    pub fn until(&mut self, unix_ms: i64) {
        self.until_ms = Some(unix_ms);
    }

    /// The board was asked, and last started because of this.
    pub fn asked(&mut self, cause: Restart) {
        self.cause = Some(cause);
    }

    /// Looks whether the board has started anew.
    pub fn look(&mut self, now: &Clock) {
        self.restarted |= now.is_behind(&self.before);
    }

    /// All that is known, in words.
    pub fn words(&self) -> String {
        let mut words = self.what.to_owned();
        if self.restarted {
            words += " and had restarted";
            if let Some(cause) = &self.cause {
                words += &format!(" ({})", restarted(cause));
            }
        }
        // A clock that was set meanwhile tells nothing.
        let lasted_ms = self.until_ms.and_then(|end| end.checked_sub(self.from_ms));
        if let Some(lasted_ms) = lasted_ms.filter(|ms| *ms >= 0) {
            words += &format!(", for {:.1} s", lasted_ms as f64 / 1000.0);
        }
        words + &at(self.from_ms)
    }
}

/// `, at` a moment of the wall clock, milliseconds since 1970-01-01 UTC; nothing where it is no time.
pub fn at(unix_ms: i64) -> String {
    Timestamp::from_millisecond(unix_ms).map_or(String::new(), |time| format!(", at {time:.0}"))
}
