//! One axis in the stream: what its words are worth, and whether it needs a reset.

use inm_protocol::{AxisCounters, Code, Flags, Trouble};

use crate::ads1281::register::Output;
use crate::ads1281::slip::{Slip, SlipDetector, Verdict};
use crate::ads1281::word::{Reading, Sign, Word};
use crate::ads1281::{Error, SETTLING_READINGS};

/// Conversions without a DRDY edge that make a stall.
pub(super) const STALLED: u32 = 8;
/// Words of all ones or zeros in a row that make a stuck bus.
const STUCK: u32 = 8;
/// Such words in a row that are flagged whatever came before. A good axis has one in a million
/// by chance.
const UNIFORM: u32 = 3;
/// Distance from zero of the last good word, in 31-bit steps, from which one uniform word is
/// flagged at once: 0.15 mV at a reference of 5 V.
const FAR: u32 = 1 << 16;
/// A broken sign adds this to a leaky count, a good one takes one off.
const BROKEN_STEP: u32 = 8;
/// The leaky count that makes a slip: 16 broken signs with no good one in between, or half of
/// 32 words as on a slipped axis around zero. Torn words come singly.
const BROKEN_LIMIT: u32 = 112;
/// Words after which a recovery counts as lasting.
const LASTING: u32 = 1000;

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
        /// Timer at which it may be configured, ticks.
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
    /// Flags of the words while the axis is not running, beside `MISSED`.
    cause: Flags,
    last: Word,
    detector: SlipDetector,
    /// Slipped and reset, and no usual word since.
    slip_again: bool,
    uniform_run: u32,
    missed_run: u32,
    broken: u32,
    /// One of them was positive. The bit behind the word, which a doubled stream takes in, is
    /// zero and breaks negative signs only; a halved one shows a value bit and breaks both.
    broken_positive: bool,
    since_clip: u32,
    good: u32,
}

impl Axis {
    pub(super) const fn new() -> Self {
        Self {
            counters: AxisCounters {
                over_range: 0,
                torn: 0,
                missed: 0,
                slipped: 0,
                stuck: 0,
                stalled: 0,
                registers_lost: 0,
                resets: 0,
            },
            state: State::Running,
            attempts: 0,
            cause: Flags::NONE,
            last: Word(0),
            detector: SlipDetector::new(),
            slip_again: false,
            uniform_run: 0,
            missed_run: 0,
            broken: 0,
            broken_positive: false,
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
        self.detector.realigned();
        self.forget_runs();
    }

    /// Stops: its words are not read until it has recovered.
    pub(super) fn rest(&mut self, trouble: Trouble, until: u64) {
        match trouble {
            Trouble::Stalled => self.counters.stalled = self.counters.stalled.saturating_add(1),
            Trouble::RegisterLost { .. } => {
                self.counters.registers_lost = self.counters.registers_lost.saturating_add(1);
            }
            Trouble::Stuck { .. } => {
                self.counters.stuck = self.counters.stuck.saturating_add(1);
                self.cause = self.cause.with(Flags::STUCK);
            }
            Trouble::Slipped { .. } => {
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
        self.broken_positive = false;
    }

    pub(super) fn is_running(&self) -> bool {
        self.state == State::Running
    }

    /// Whether the bus can be trusted with a register now: what a bad word announces is better
    /// told by the next words.
    pub(super) fn is_steady(&self) -> bool {
        self.is_running() && self.uniform_run == 0 && self.broken == 0 && !self.detector.suspects()
    }

    /// Whether DRDY was missing at the last conversion, for the first time in a row.
    pub(super) fn has_just_missed(&self) -> bool {
        self.missed_run == 1
    }

    /// An axis that is not running repeats its last word.
    pub(super) fn absent(&mut self) -> Judgement {
        self.counters.missed = self.counters.missed.saturating_add(1);
        Judgement {
            code: self.last.code(),
            flags: Flags::MISSED.with(self.cause),
            trouble: None,
        }
    }

    /// What the reading at one conversion of X says.
    #[inline]
    pub(super) fn judge(
        &mut self,
        reading: Result<Option<Reading>, Error>,
        output: Output,
    ) -> Judgement {
        match reading {
            Ok(Some(reading)) => self.judge_word(reading, output),
            Ok(None) => {
                self.missed_run = self.missed_run.saturating_add(1);
                let stalled = self.missed_run == STALLED;
                Judgement {
                    trouble: stalled.then_some(Trouble::Stalled),
                    ..self.absent()
                }
            }
            Err(error) => Judgement {
                trouble: Some(error.trouble()),
                ..self.absent()
            },
        }
    }

    fn judge_word(&mut self, Reading { word, torn }: Reading, output: Output) -> Judgement {
        self.missed_run = 0;
        let mut flags = Flags::NONE;
        let mut trouble = None;

        match word.uniform() {
            None => self.uniform_run = 0,
            Some(ones) => {
                self.uniform_run = self.uniform_run.saturating_add(1);
                if self.uniform_run >= UNIFORM || self.last.value().unsigned_abs() >= FAR {
                    flags = flags.with(Flags::STUCK);
                }
                if self.uniform_run == STUCK {
                    trouble = Some(Trouble::Stuck { ones });
                }
            }
        }
        self.since_clip = self.since_clip.saturating_add(1);
        let mut broken = false;
        match word.sign(output) {
            Sign::Good => {}
            Sign::OverRange => {
                flags = flags.with(Flags::OVER_RANGE);
                self.counters.over_range = self.counters.over_range.saturating_add(1);
                // One event an overload: the filter remembers that many conversions.
                if self.since_clip > SETTLING_READINGS {
                    trouble = trouble.or(Some(Trouble::OverRange));
                }
                self.since_clip = 0;
            }
            Sign::Broken => broken = true,
        }
        if torn || broken {
            flags = flags.with(Flags::TORN);
            self.counters.torn = self.counters.torn.saturating_add(1);
        }
        if let Some(slip) = self.slip(word, broken, flags) {
            flags = flags.with(Flags::SLIPPED);
            trouble = trouble.or(slip);
        }

        if flags.is_none() {
            self.good = self.good.saturating_add(1);
            if self.good == LASTING {
                self.attempts = 0;
            }
        }
        if !flags.has(Flags::STUCK) {
            self.last = word;
        }
        Judgement {
            code: word.code(),
            flags,
            trouble,
        }
    }

    /// `None`: no sign of a slip. `Some(None)`: perhaps. `Some(Some(..))`: surely.
    #[inline]
    fn slip(&mut self, word: Word, broken: bool, flags: Flags) -> Option<Option<Trouble>> {
        if broken {
            self.broken += BROKEN_STEP;
            self.broken_positive |= word.value() >= 0;
            if self.broken >= BROKEN_LIMIT {
                self.broken = 0;
                return Some(Some(Trouble::Slipped {
                    doubled: !self.broken_positive,
                }));
            }
        } else if self.broken > 0 {
            self.broken -= 1;
            self.broken_positive &= self.broken > 0;
        }
        // Torn, clipped and stuck words say nothing about the level. A broken sign does not
        // hide it: behind a slip half of the words may have one.
        if !broken && !flags.is_none() {
            return None;
        }
        match self.detector.push(word.value()) {
            Verdict::Usual => {
                self.slip_again = false;
                None
            }
            Verdict::Strange => None,
            Verdict::Suspect(_) => Some(None),
            // A reset has realigned the stream and the level is still there: it is the signal.
            Verdict::Slipped(_) if self.slip_again => {
                self.slip_again = false;
                self.detector = SlipDetector::new();
                None
            }
            Verdict::Slipped(slip) => Some(Some(Trouble::Slipped {
                doubled: slip == Slip::Doubled,
            })),
        }
    }
}
