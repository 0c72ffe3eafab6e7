//! From the common SYNC to the first word: the filters fill, and the converters are looked at.
//!
//! No DRDY falls meanwhile, so nothing but the platform's heartbeat wakes a board that sleeps.

use ads1281::SETTLING_READINGS;
use embedded_hal::digital::OutputPin;
use inm_protocol::{AXES, Trouble};

use super::axis::STALLED;
use super::job::{Job, Task};
use super::{Instrument, Stage};
use crate::Platform;
use crate::platform::LONGEST_SLEEP_US;

/// How late a look may be done, microseconds: the loop sleeps, then takes a step of 2 ms, as when it
/// configures, and looks at three converters in 75 us each.
const LATE_US: u32 = LONGEST_SLEEP_US + 2000 + 3 * 75;

/// The shortest data period, microseconds: 4000/s, the fastest that the link carries.
const SHORTEST_PERIOD_US: u32 = 250;

/// Data periods after SYNC at which the converters are looked at: as late as it is sure to come
/// before the first word. What slips between the two is found by the first proof of the stream.
const LOOK_READINGS: u32 = SETTLING_READINGS - LATE_US.div_ceil(SHORTEST_PERIOD_US);

impl<P: Platform> Instrument<P> {
    /// One rising edge on the common SYNC: the converters start anew together.
    #[inline(never)]
    pub(super) fn synchronise(&mut self, job: Option<Job>) {
        // Two converter clocks (0.5 us) each; a pin that cannot fail is the rule, and one that
        // does shows as stalled converters.
        let [x, ..] = &mut self.converters;
        let _ = self.sync.set_low();
        x.pause_us(1);
        let _ = self.sync.set_high();
        x.pause_us(1);
        self.forget_edges();
        self.stage = Stage::Settle {
            since: self.platform.now(),
            job,
            looked: false,
        };
    }

    fn forget_edges(&mut self) {
        for converter in &mut self.converters {
            converter.forget_edge();
        }
    }

    /// Waits until the filters are full. Words within 63 data periods of SYNC are dropped
    /// whether or not DRDY announces them.
    pub(super) fn settle(
        &mut self,
        edge: Option<u64>,
        now: u64,
        since: u64,
        job: Option<Job>,
        looked: bool,
    ) -> bool {
        let settled = since + self.clock.periods(SETTLING_READINGS) - self.clock.periods(1) / 2;
        // 0.46 periods more at 4000/s, and 1 % on the internal oscillator.
        let late = settled + self.clock.periods(2) - self.clock.periods(1) / 4;
        match edge {
            // The board was held up. A look would cost this word, and nothing says how many more.
            Some(stamp) if stamp >= settled && !looked => self.settle_again(job, now),
            _ if !looked && now >= since + self.clock.periods(LOOK_READINGS) => {
                self.stage = Stage::Settle {
                    since,
                    job,
                    looked: true,
                };
                self.look_ahead(job, now);
            }
            // It was restarted since SYNC and no more converts with the others, or the board was held
            // up between the look and the first word.
            Some(stamp)
                if stamp > late || stamp >= settled && !self.clock.is_in_step(stamp - since) =>
            {
                self.came_late(now, job);
            }
            Some(stamp) if stamp >= settled => self.settled(stamp, now, job),
            Some(_) => self.forget_edges(),
            None if now > settled + self.clock.periods(2 * STALLED) => {
                self.trigger_failed(now, job);
            }
            None => return job.is_none() && self.recover(now),
        }
        true
    }

    /// The first word came before the look. A job has its attempts, a stream begins anew until it is
    /// there.
    #[cold]
    fn settle_again(&mut self, job: Option<Job>, now: u64) {
        match job {
            Some(job) => self.attempt_failed(job, self.trigger, Trouble::Stalled, now),
            None => self.synchronise(None),
        }
    }

    /// Looks at the converters before their first word after a silence, in which a bit may have
    /// slipped: the silence would end it with the first clock, of which that word were spoilt.
    fn look_ahead(&mut self, job: Option<Job>, now: u64) {
        for axis in 0..AXES {
            if job.is_none() && !self.axes[axis].is_running() {
                continue;
            }
            match (self.look(axis), job) {
                (Ok(()), _) => {}
                (Err(trouble), None) => self.fail(axis, trouble, now),
                (Err(trouble), Some(job)) => {
                    self.attempt_failed(job, axis, trouble, now);
                    break;
                }
            }
        }
    }

    fn settled(&mut self, stamp: u64, now: u64, job: Option<Job>) {
        self.fresh = true;
        match job.map(|job| (job, job.task)) {
            None => {
                self.stage = Stage::Stream;
                self.conversion(stamp);
            }
            Some((job, Task::Start)) => {
                self.begin_stream(job);
                self.conversion(stamp);
            }
            Some((job, Task::Calibrate(kind))) => self.begin_calibration(job, kind, now),
            Some((job, Task::SelfTest)) => self.begin_self_test(job, now),
        }
    }

    /// The first edge after SYNC came, but too late.
    #[cold]
    fn came_late(&mut self, now: u64, job: Option<Job>) {
        match job {
            Some(job) => self.attempt_failed(job, self.trigger, Trouble::Stalled, now),
            None => self.trigger_failed(now, None),
        }
    }

    /// There was no edge after SYNC.
    fn trigger_failed(&mut self, now: u64, job: Option<Job>) {
        match job {
            Some(job) => self.refuse_job(job, 0, Trouble::Stalled),
            None => {
                self.stage = Stage::Stream;
                if self.axes[self.trigger].is_running() {
                    self.fail(self.trigger, Trouble::Stalled, now);
                }
            }
        }
    }
}
