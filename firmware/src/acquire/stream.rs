//! One conversion of all axes, from its stamp to the batch.

use inm_protocol::{AXES, Code, Event, Flags, Trouble};

use super::axis::{Axis, STALLED};
use super::batch::Conversion;
use super::clock::Interval;
use super::read_back::Rounds;
use super::{Instrument, Job, Stage};
use crate::converters::trouble;
use crate::{Part, Platform};

/// Where the stream stands.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Position {
    /// Number of the command that began the stream.
    pub(super) stream: u16,
    /// Index and stamp of the last conversion.
    last: Option<(u64, u64)>,
}

impl Position {
    /// Index of the next conversion.
    pub(super) fn next_index(&self) -> u64 {
        self.last.map_or(0, |(index, _)| index + 1)
    }

    /// Ticks from the stamp of the last conversion to now; 0 before the first.
    pub(super) fn since(&self, now: u64) -> u64 {
        self.last.map_or(0, |(_, stamp)| now.saturating_sub(stamp))
    }
}

impl<P: Platform> Instrument<P> {
    /// Index 0 of the stream of a job comes next, once the converters have settled. Beginning 48 KB of bins takes longer
    /// than the first word can wait at 4000/s.
    pub(super) fn prepare_stream(&mut self, job: Job) {
        self.position = Position {
            stream: job.id,
            last: None,
        };
        self.platform.bins().begin(0);
    }

    /// The converters have settled after a start command, and the first word is there.
    pub(super) fn begin_stream(&mut self, job: Job) {
        self.rounds = Rounds::default();
        self.batcher.restart(job.id);
        self.mark = None;
        self.lost_conversions = 0;
        self.recovering = [false; AXES];
        for axis in &mut self.axes {
            axis.start();
        }
        self.choose_trigger(self.platform.now());
        self.stage = Stage::Stream;
        self.answer_started(job);
        // What was counted before this stream.
        self.send_health(self.platform.now(), None);
    }

    /// Reads the conversion that DRDY announced at `stamp`.
    pub(super) fn conversion(&mut self, stamp: u64) {
        self.platform.enter(Part::Read);
        self.take_conversion(stamp);
        self.platform.enter(Part::Rest);
    }

    fn take_conversion(&mut self, stamp: u64) {
        let (index, interval) = match self.position.last {
            None => (0, Interval::Next),
            Some((index, last)) => match self.clock.between(last, stamp) {
                Interval::Early => {
                    self.axes[self.trigger].suspected = true;
                    return;
                }
                Interval::Next => {
                    self.clock.learn(last, stamp);
                    (index + 1, Interval::Next)
                }
                Interval::Gap { periods } => (index + periods, Interval::Gap { periods }),
            },
        };
        if !self.clock.in_time_to_read(stamp, self.platform.now()) {
            // Too late for any word: the conversion is lost, and the index shows it.
            return;
        }
        if let Interval::Gap { periods } = interval {
            self.after_gap(index, periods.saturating_sub(1));
        }
        self.position.last = Some((index, stamp));

        let mut troubles = [None; AXES];
        let conversion = self.read_axes(index, stamp, &mut troubles);
        let Conversion { codes, flags, .. } = &conversion;
        self.platform.enter(Part::Bins);
        self.platform.bins().conversion(index, codes, flags);
        self.platform.enter(Part::Framing);
        if let Some(batch) = self.batcher.push(&conversion) {
            self.outbox.batch(&mut self.platform, batch);
        }
        if troubles.iter().any(Option::is_some) {
            let now = self.platform.now();
            for (axis, trouble) in troubles.into_iter().enumerate() {
                match trouble {
                    None => {}
                    // The part recovers from an overload by itself.
                    Some(Trouble::OverRange) => {
                        self.event(index, Some(axis as u8), Trouble::OverRange);
                    }
                    Some(trouble) => self.fail(axis, trouble, now),
                }
            }
        }
        self.platform.enter(Part::ReadBack);
        self.read_back(stamp);
    }

    /// The conversion with this index does not follow the last one: `lost` are missing between.
    #[cold]
    fn after_gap(&mut self, index: u64, lost: u64) {
        self.lost_conversions += lost;
        self.flush_batch();
        if self.recovering == [false; AXES] {
            self.unforeseen_gap(lost);
            return;
        }
        for axis in &mut self.axes {
            // Those that ran were proved ahead of SYNC, the others when they were configured.
            axis.proven = index;
        }
        for (axis, recovered) in (0..).zip(core::mem::take(&mut self.recovering)) {
            if recovered {
                let lost = u32::try_from(lost).unwrap_or(u32::MAX);
                self.event(index, Some(axis), Trouble::Recovered { lost });
            }
        }
    }

    fn read_axes(
        &mut self,
        index: u64,
        stamp: u64,
        troubles: &mut [Option<Trouble>; AXES],
    ) -> Conversion {
        let mut conversion = Conversion {
            index,
            stamp,
            codes: [Code(0); AXES],
            flags: [Flags::NONE; AXES],
        };
        let output = self.configs[0].config0.output;
        let axes = self.axes.iter_mut().zip(&mut self.converters);
        for (axis, (state, converter)) in axes.enumerate() {
            // Later, the next word would be taken for this one.
            self.platform.enter(Part::Read);
            let in_time = self.clock.in_time_to_read(stamp, self.platform.now());
            let reading =
                (state.is_running() && in_time).then(|| converter.take_new().map_err(trouble));
            self.platform.enter(Part::Check);
            let judgement = match reading {
                Some(reading) => state.judge(reading, output),
                None => state.absent(),
            };
            let mut trouble = judgement.trouble;
            if state.has_just_missed() {
                state.suspected = true;
                // Restarted since SYNC, it no more converts with the others.
                if self.fresh {
                    trouble = trouble.or(Some(Trouble::Stalled));
                }
            }
            conversion.codes[axis] = judgement.code;
            conversion.flags[axis] = judgement.flags;
            troubles[axis] = trouble;
        }
        self.fresh = false;
        conversion
    }

    /// One DRDY drives everything: without it only the timer tells.
    pub(super) fn watch_trigger(&mut self, now: u64) -> bool {
        let Some((_, stamp)) = self.position.last else {
            return false;
        };
        let since = stamp.max(self.trigger_since);
        let stalled = self.axes[self.trigger].is_running()
            && now.saturating_sub(since) > self.clock.periods(STALLED) + self.clock.periods(1) / 2;
        if stalled {
            self.flush_batch();
            self.fail(self.trigger, Trouble::Stalled, now);
        }
        stalled
    }

    /// Lets the first axis that runs drive the reading: X, unless X is being reset.
    pub(super) fn choose_trigger(&mut self, now: u64) {
        let running = self.axes.iter().position(Axis::is_running);
        self.drive_by(running.unwrap_or(0), now);
    }

    /// Lets this axis drive the reading.
    #[inline(never)]
    pub(super) fn drive_by(&mut self, trigger: usize, now: u64) {
        if trigger != self.trigger {
            self.trigger = trigger;
            self.trigger_since = now;
            self.platform.trigger_on(trigger);
        }
    }

    /// Sends what has been gathered: a gap follows, or the end.
    #[inline(never)]
    pub(super) fn flush_batch(&mut self) {
        // The host will be past what was marked when it hears of it.
        self.mark = None;
        if let Some(batch) = self.batcher.take() {
            self.outbox.batch(&mut self.platform, batch);
        }
    }

    #[inline(never)]
    pub(super) fn event(&mut self, index: u64, axis: Option<u8>, trouble: Trouble) {
        self.outbox.event(Event {
            index,
            axis,
            trouble,
            stream: self.position.stream,
        });
    }
}
