//! One ADS1281: registers, read mode, conversions and faults behind its pins.
//!
//! [`Bench`](crate::Bench) owns three of them and the time; this file is what happens to one when
//! SCLK runs or time passes. Time is caught up with lazily: nothing happens in a converter until
//! somebody looks at it.

use crate::{
    Conversion, Fault, Registers, Rule, Sent, Signal, Tear,
    alignment::Alignment,
    command::Decoder,
    drdy::{Moment, Timeline},
    fault::Schedule,
    sent::Ledger,
    serial::Serial,
    time::{COMMAND_GAP_PS, POWER_ON_PS},
};

mod calibration;
mod clocking;
mod commands;
mod trouble;

use calibration::Calibration;

/// How data are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReadMode {
    /// Every conversion goes to the output register (RDATAC).
    #[default]
    Continuous,
    /// Registers can be accessed, data come on RDATA (SDATAC).
    Stopped,
}

/// A register-level ADS1281 with a signal at its input.
#[derive(Debug, Clone)]
pub struct Converter<S> {
    conversion: Conversion<S>,
    registers: Registers,
    decoder: Decoder,
    alignment: Alignment,
    serial: Serial,
    timeline: Timeline,
    ledger: Ledger,
    /// Word of the latest conversion.
    word: u32,
    mode: ReadMode,
    mode_after_reset: ReadMode,
    tear: Tear,
    /// RDATA came and DRDY has not fallen since.
    requested: bool,
    standby: bool,
    calibration: Option<Calibration>,
    /// The conversion under way is a calibration's and shows no fall.
    silent: bool,
    /// Last SYNC that restarted the conversions, for the continuous-sync rule.
    synced_ps: Option<u64>,
    schedule: Schedule,
    drdy_dead: bool,
    /// Level that DOUT is stuck at, and the conversion that ends it.
    stuck: Option<(bool, u64)>,
    late_read: Option<u8>,
    pub(crate) bus_error: bool,
    /// The part reset itself: its driver cannot know that it is no longer stopped.
    excused: bool,
    breach: Option<(u64, Rule)>,
}

impl<S: Signal> Converter<S> {
    /// A converter that is being powered up, with `signal` at its input.
    pub fn new(signal: S) -> Self {
        let registers = Registers::default();
        let mut timeline = Timeline::default();
        timeline.restart(POWER_ON_PS, &registers);
        Self {
            conversion: Conversion::new(signal),
            registers,
            decoder: Decoder::default(),
            alignment: Alignment::default(),
            serial: Serial::default(),
            timeline,
            ledger: Ledger::new(),
            word: 0,
            mode: ReadMode::default(),
            mode_after_reset: ReadMode::default(),
            tear: Tear::default(),
            requested: false,
            standby: false,
            calibration: None,
            silent: false,
            synced_ps: None,
            schedule: Schedule::default(),
            drdy_dead: false,
            stuck: None,
            late_read: None,
            bus_error: false,
            excused: false,
            breach: None,
        }
    }

    /// Sets the read mode after power-on and RESET.
    ///
    /// The sources disagree: read-continuous, which is the default here and the stricter of the
    /// two for a driver, or stopped (Texas Instruments' example code for the ADS1282).
    #[must_use]
    pub fn mode_after_reset(mut self, mode: ReadMode) -> Self {
        self.mode = mode;
        self.mode_after_reset = mode;
        self
    }

    /// Sets what an update during a read does.
    #[must_use]
    pub fn tearing(mut self, tear: Tear) -> Self {
        self.tear = tear;
        self
    }

    /// The registers as they are.
    pub fn registers(&self) -> &Registers {
        &self.registers
    }

    /// Count and digest of the words so far. Zeros put out while continuous-sync settles, and
    /// readings that a calibration averages, are no words.
    pub fn sent(&self) -> Sent {
        self.ledger.sent
    }

    /// Word number `index`, counted from zero, if it is among the latest 32.
    pub fn word(&self, index: u64) -> Option<u32> {
        self.ledger.word(index)
    }

    /// Schedules a fault at conversion `at` (the count of [`Converter::sent`]); false if there is
    /// no room for it.
    pub(crate) fn inject_at(&mut self, at: u64, fault: Fault) -> bool {
        self.schedule.add(at, fault)
    }

    /// What the driver did wrong since the last call.
    pub(crate) fn take_breach(&mut self) -> Option<(u64, Rule)> {
        self.breach.take()
    }

    pub(crate) fn timeline(&mut self) -> &mut Timeline {
        &mut self.timeline
    }

    /// Lets everything happen that is due by `now_ps`.
    pub(crate) fn catch_up(&mut self, now_ps: u64) {
        while let Some((at_ps, moment)) = self.timeline.take(now_ps) {
            match moment {
                Moment::Load => self.load(at_ps),
                Moment::Fall => self.fall(at_ps),
            }
        }
    }

    /// Makes the next word and puts it into the output register.
    fn load(&mut self, at_ps: u64) {
        while let Some(fault) = self.schedule.due(self.ledger.sent.words()) {
            self.suffer(at_ps, fault);
            if fault == Fault::BrownOut {
                return;
            }
        }
        let settled = self.timeline.settled(at_ps);
        self.silent = settled && self.calibration.is_some();
        if self.silent {
            self.calibrate();
            return;
        }
        if !settled {
            self.word = 0;
        } else {
            self.word = self.conversion.next_word(&self.registers);
            self.ledger.push(self.word);
            self.stuck = self
                .stuck
                .filter(|&(_, end)| self.ledger.sent.words() <= end);
        }
        if self.mode == ReadMode::Continuous {
            // Without SCLK for the length of a gap, a read is over, however many bits it took.
            if at_ps < self.timeline.sclk_ps + COMMAND_GAP_PS {
                self.serial.overwrite(self.word, self.tear);
            } else {
                self.serial.load(self.word);
            }
        }
    }

    /// Shows the word on DRDY.
    fn fall(&mut self, at_ps: u64) {
        if self.drdy_dead || self.silent {
            return;
        }
        self.timeline.fall(at_ps);
        if core::mem::take(&mut self.requested) {
            self.serial.load(self.word);
        }
    }

    fn breach(&mut self, at_ps: u64, rule: Rule) {
        // What a slip makes of a command is no fault of who sent it.
        if self.serial.slip.is_some() || rule == Rule::NotStopped && self.excused {
            return;
        }
        self.breach.get_or_insert((at_ps, rule));
    }
}
