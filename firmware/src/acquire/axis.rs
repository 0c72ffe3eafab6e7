//! One axis in the stream: where it stands, and what happened to it. What its words are worth: [`judge`].

mod judge;

use ads1281::SETTLING_READINGS;
use ads1281::slip::SlipDetector;
use ads1281::slip_mean::SlipMeanDetector;
use ads1281::word::Word;
use inm_protocol::{AxisCounters, Code, Flags, Trouble};

use crate::converters::code;

/// Conversions without a DRDY edge that make a stall.
pub(super) const STALLED: u32 = 8;
/// Where an axis stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// Its words are read.
    Running,
    /// No clock until then: its serial interface starts a new byte after 64 data periods.
    Resting {
        /// Timer, ticks.
        until: u64,
    },
    /// RESET was sent.
    Resetting {
        /// Timer at which its registers may be read, ticks.
        until: u64,
    },
    /// It showed the registers of an ADS1281 after a RESET.
    Identified {
        /// Timer at which it is configured, ticks: the others are read once before.
        until: u64,
    },
    /// Configured; it has to show an edge of DRDY before the others are disturbed by a
    /// common SYNC.
    Proving {
        /// Timer, ticks, at which it has failed.
        until: u64,
    },
}

/// What is made of one conversion of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Judgement {
    pub code: Code,
    pub flags: Flags,
    pub trouble: Option<Trouble>,
}

/// One axis.
#[derive(Debug)]
pub(super) struct Axis {
    pub counters: AxisCounters,
    pub state: State,
    /// Failed recoveries in a row.
    pub attempts: u32,
    /// Words before the conversion with this index are proven to be aligned (`prove`).
    pub proven: u64,
    /// Something gives reason to look at CONFIG0 at once.
    pub suspected: bool,
    /// Flags of the words while the axis is not running, beside `MISSED`.
    cause: Flags,
    last: Word,
    detector: SlipDetector,
    mean_detector: SlipMeanDetector,
    /// Slipped and reset, and no usual word since.
    slip_again: bool,
    uniform_run: u32,
    missed_run: u32,
    broken: u32,
    /// Since they began, a positive word was broken or a negative one was not: the lowest bit
    /// is one of the value, as in a halved stream. A doubled one shows the level behind the
    /// word, zero or the sign, which breaks all negative words or none.
    value_bit: bool,
    since_clip: u32,
    good: u32,
}

impl Axis {
    pub(super) fn new() -> Self {
        Self {
            counters: AxisCounters::default(),
            state: State::Running,
            attempts: 0,
            proven: 0,
            suspected: false,
            cause: Flags::NONE,
            last: Word(0),
            detector: SlipDetector::new(),
            mean_detector: SlipMeanDetector::default(),
            slip_again: false,
            uniform_run: 0,
            missed_run: 0,
            broken: 0,
            value_bit: false,
            since_clip: SETTLING_READINGS,
            good: 0,
        }
    }

    /// Begins a stream: the counters stay, all else starts anew.
    pub(super) fn start(&mut self) {
        let counters = self.counters;
        *self = Self::new();
        self.counters = counters;
    }

    /// Runs again after a reset.
    pub(super) fn resume(&mut self) {
        self.state = State::Running;
        self.slip_again = self.cause.has(Flags::SLIPPED);
        self.cause = Flags::NONE;
        self.suspected = false;
        self.detector.realigned();
        self.mean_detector.realigned();
        self.forget_runs();
    }

    /// Stops: its words are not read until it has recovered.
    pub(super) fn rest(&mut self, trouble: Trouble, until: u64) {
        match trouble {
            Trouble::Stalled => self.counters.stalled = self.counters.stalled.saturating_add(1),
            Trouble::RegisterLost { .. } | Trouble::WrongId { .. } => {
                self.counters.registers_lost = self.counters.registers_lost.saturating_add(1);
            }
            Trouble::Stuck { .. } => {
                self.counters.stuck = self.counters.stuck.saturating_add(1);
                self.cause = self.cause.with(Flags::STUCK);
            }
            Trouble::Bus => self.counters.stuck = self.counters.stuck.saturating_add(1),
            Trouble::Slipped { .. } | Trouble::Misaligned => {
                self.counters.slipped = self.counters.slipped.saturating_add(1);
                self.cause = self.cause.with(Flags::SLIPPED);
            }
            _ => {}
        }
        self.attempts = self.attempts.saturating_add(1);
        self.good = 0;
        self.state = State::Resting { until };
    }

    fn forget_runs(&mut self) {
        self.uniform_run = 0;
        self.missed_run = 0;
        self.broken = 0;
        self.value_bit = false;
    }

    pub(super) fn is_running(&self) -> bool {
        self.state == State::Running
    }

    /// Whether the bus can be trusted with a register now: what a bad word announces is better
    /// told by the next words.
    pub(super) fn is_steady(&self) -> bool {
        self.is_running() && self.uniform_run == 0 && self.broken == 0 && !self.detector.suspects()
    }

    /// Whether DRDY was missing at the last conversion.
    pub(super) fn is_missing(&self) -> bool {
        self.missed_run > 0
    }

    /// Whether DRDY was missing at the last conversion, for the first time in a row.
    pub(super) fn has_just_missed(&self) -> bool {
        self.missed_run == 1
    }

    /// An axis that is not running repeats its last word.
    pub(super) fn absent(&mut self) -> Judgement {
        self.counters.missed = self.counters.missed.saturating_add(1);
        Judgement {
            code: code(self.last),
            flags: Flags::MISSED.with(self.cause),
            trouble: None,
        }
    }
}

#[cfg(test)]
mod tests;
