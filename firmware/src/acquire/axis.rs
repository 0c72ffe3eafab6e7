//! One axis in the stream: what its words are worth, and whether it needs a reset.

use inm_protocol::{AxisCounters, Code, Flags, Trouble};

use crate::ads1281::register::Output;
use crate::ads1281::slip::{Slip, SlipDetector, Verdict};
use crate::ads1281::slip_mean::SlipMeanDetector;
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
        let negative = word.value() < 0;
        if broken {
            self.broken += BROKEN_STEP;
            self.value_bit |= !negative;
            if self.broken >= BROKEN_LIMIT {
                self.broken = 0;
                return Some(Some(Trouble::Slipped {
                    doubled: !self.value_bit,
                }));
            }
        } else if self.broken > 0 {
            self.broken -= 1;
            self.value_bit = (self.value_bit | negative) && self.broken > 0;
        }
        // Torn, clipped and stuck words say nothing about the level. A broken sign does not
        // hide it: behind a slip half of the words may have one.
        if !broken && !flags.is_none() {
            return None;
        }
        let verdict = self.detector.push(word.value());
        let slip = match (verdict, self.mean_detector.push(word.value())) {
            (Verdict::Slipped(slip), _) | (_, Some(slip)) => slip,
            (Verdict::Suspect(_), None) => return Some(None),
            (Verdict::Usual, None) => {
                self.slip_again = false;
                return None;
            }
            (Verdict::Strange, None) => return None,
        };
        if self.slip_again {
            // A reset has realigned the stream and the level is still there: it is the signal.
            self.slip_again = false;
            self.detector = SlipDetector::new();
            self.mean_detector = SlipMeanDetector::default();
            return None;
        }
        Some(Some(Trouble::Slipped {
            doubled: slip == Slip::Doubled,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.5 g on the 4 g range, in 31-bit steps.
    const LEVEL: i32 = 66_000_000;

    fn judge(axis: &mut Axis, value: i32) -> Judgement {
        let word = Word((value << 1).cast_unsigned() | u32::from(value < 0));
        axis.judge(Ok(Some(Reading { word, torn: false })), Output::Fir)
    }

    /// Troubles of `count` equal values.
    fn troubles(axis: &mut Axis, value: i32, count: u32) -> Vec<Trouble> {
        (0..count)
            .filter_map(|_| judge(axis, value).trouble)
            .collect()
    }

    #[test]
    fn a_level_that_a_reset_does_not_change_is_the_signal() {
        let slipped = Trouble::Slipped { doubled: true };
        let mut axis = Axis::new();
        assert_eq!(troubles(&mut axis, LEVEL, 200), []);
        assert_eq!(troubles(&mut axis, 2 * LEVEL, 16), [slipped]);
        axis.rest(slipped, 0);
        axis.resume();
        assert_eq!(troubles(&mut axis, 2 * LEVEL, 200), []);
        // And is watched from then on.
        assert_eq!(troubles(&mut axis, 4 * LEVEL, 16), [slipped]);
    }

    #[test]
    fn a_level_that_a_reset_brings_back_is_watched_as_before() {
        let slipped = Trouble::Slipped { doubled: false };
        let mut axis = Axis::new();
        assert_eq!(troubles(&mut axis, LEVEL, 200), []);
        for _ in 0..3 {
            assert_eq!(troubles(&mut axis, LEVEL / 2, 16), [slipped]);
            axis.rest(slipped, 0);
            axis.resume();
            assert_eq!(troubles(&mut axis, LEVEL, 1), []);
        }
        assert_eq!(axis.counters.slipped, 3);
    }

    #[test]
    fn zero_words_around_zero_are_flagged_from_the_third_on() {
        let mut axis = Axis::new();
        judge(&mut axis, 1000);
        let flags: Vec<bool> = (0..STUCK)
            .map(|_| judge(&mut axis, 0).flags.has(Flags::STUCK))
            .collect();
        let expected = [false, false, true, true, true, true, true, true];
        assert_eq!(flags, expected);
    }

    #[test]
    fn a_missing_word_repeats_the_last() {
        let mut axis = Axis::new();
        judge(&mut axis, LEVEL);
        let mut trouble = None;
        for _ in 0..STALLED {
            assert_eq!(trouble, None);
            let missed = axis.judge(Ok(None), Output::Fir);
            assert_eq!(
                (missed.code, missed.flags),
                (Code(2 * LEVEL), Flags::MISSED)
            );
            trouble = missed.trouble;
        }
        assert_eq!(trouble, Some(Trouble::Stalled));
    }

    #[test]
    fn an_overload_that_flickers_is_one_event() {
        let mut axis = Axis::new();
        judge(&mut axis, LEVEL);
        let clipped = Ok(Some(Reading {
            word: Word(0x7FFF_FFFF),
            torn: false,
        }));
        let mut told = 0;
        for _ in 0..20 {
            told += u32::from(axis.judge(clipped, Output::Fir).trouble.is_some());
            judge(&mut axis, LEVEL);
        }
        assert_eq!((told, axis.counters.over_range), (1, 20));
    }
}
