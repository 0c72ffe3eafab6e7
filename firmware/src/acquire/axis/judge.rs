//! What the words of an axis are worth, and whether they show that it needs a reset.

use ads1281::SETTLING_READINGS;
use ads1281::register::Output;
use ads1281::slip::{Slip, SlipDetector, Verdict};
use ads1281::slip_mean::SlipMeanDetector;
use ads1281::word::{Reading, Sign, Word};
use inm_protocol::{Flags, Trouble};

use super::{Axis, Judgement, STALLED};
use crate::converters::code;

/// Words of all ones or zeros in a row that make a stuck bus.
pub(super) const STUCK: u32 = 8;
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

impl Axis {
    /// What the reading at one conversion of X says.
    #[inline]
    pub(in super::super) fn judge(
        &mut self,
        reading: Result<Option<Reading>, Trouble>,
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
            Err(trouble) => Judgement {
                trouble: Some(trouble),
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
            code: code(word),
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
