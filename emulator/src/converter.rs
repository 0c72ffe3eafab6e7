//! One ADS1281: registers, read mode, conversions and faults behind its pins.
//!
//! [`Bench`](crate::Bench) owns three of them and the time; this file is what happens to one when
//! SCLK runs or time passes. Time is caught up with lazily: nothing happens in a converter until
//! somebody looks at it.

use crate::{
    Conversion, Fault, Registers, Rule, Sent, Signal, Tear,
    alignment::Alignment,
    command::{Action, Byte, Decoder},
    drdy::{Moment, Timeline},
    fault::Schedule,
    sent::Ledger,
    serial::Serial,
    time::{
        COMMAND_GAP_PS, INTERFACE_TIMEOUT_CONVERSIONS, POWER_ON_PS, SHORTEST_SCLK_PS, clocks_ps,
    },
};

mod calibration;
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

    /// Clocks a byte in and out: SCLK runs from `start_ps` with a period of `bit_ps`.
    pub(crate) fn clock(&mut self, start_ps: u64, bit_ps: u64, din: u8) -> u8 {
        self.catch_up(start_ps);
        if start_ps < POWER_ON_PS {
            self.breach(start_ps, Rule::PowerOn);
        }
        if bit_ps < SHORTEST_SCLK_PS {
            self.breach(start_ps, Rule::SclkTooFast);
        }
        let timeout = INTERFACE_TIMEOUT_CONVERSIONS * self.timeline.period_ps();
        if start_ps - self.timeline.sclk_ps >= timeout {
            self.realign();
        }
        if self.requested && din < 2 {
            self.breach(start_ps, Rule::RdataBeforeReady);
        }

        let end_ps = start_ps + 8 * bit_ps;
        let last_ps = end_ps - bit_ps / 2;
        let dout = if let Some(address) = self.decoder.register() {
            let value = self.registers.get(address).unwrap_or(0);
            self.serial.register(value)
        } else if self.timeline.next_ps().is_none_or(|next| next > last_ps) {
            self.serial.byte()
        } else {
            self.byte_across_update(start_ps, bit_ps)
        };
        self.timeline.sclk_ps = end_ps;

        if let Some(din) = self.alignment.take(din) {
            self.decode(din, start_ps + bit_ps / 2, last_ps);
        }
        match self.stuck {
            Some((true, _)) => 0xFF,
            Some((false, _)) => 0x00,
            None => dout,
        }
    }

    /// Carries out a byte as the part has put it together, clocked from `first_ps` to `last_ps`.
    fn decode(&mut self, din: u8, first_ps: u64, last_ps: u64) {
        let byte = Byte {
            din,
            first_ps,
            last_ps,
        };
        let stopped = self.mode == ReadMode::Stopped;
        let (action, breach) = self.decoder.take(byte, stopped);
        if let Some(rule) = breach {
            self.breach(first_ps, rule);
        }
        self.act(action, last_ps);
    }

    /// The serial interface begins a new byte, and the next word from its highest bit.
    fn realign(&mut self) {
        self.decoder.reset();
        self.alignment = Alignment::default();
        self.serial.slip = None;
    }

    /// A byte during which a word is made or DRDY falls: bit by bit.
    fn byte_across_update(&mut self, start_ps: u64, bit_ps: u64) -> u8 {
        let mut byte = 0;
        for bit in 0..8 {
            let rising_ps = start_ps + bit * bit_ps + bit_ps / 2;
            self.catch_up(rising_ps);
            byte = byte << 1 | u8::from(self.serial.bit());
            self.timeline.sclk_ps = rising_ps + bit_ps / 2;
        }
        byte
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

    fn act(&mut self, action: Action, at_ps: u64) {
        match action {
            Action::Nothing => {}
            Action::Wakeup => {
                if core::mem::take(&mut self.standby) {
                    self.restart(at_ps);
                }
            }
            Action::Standby => {
                self.standby = true;
                self.timeline.stop();
            }
            Action::Sync => self.sync(at_ps),
            Action::Reset => self.reset(at_ps),
            Action::ReadContinuous => {
                self.mode = ReadMode::Continuous;
                self.requested = false;
                self.serial.empty();
            }
            Action::StopContinuous => {
                self.mode = ReadMode::Stopped;
                self.excused = false;
                self.serial.empty();
            }
            Action::ReadOnce => self.requested = true,
            Action::CalibrateOffset => self.start_calibration(at_ps, false),
            Action::CalibrateGain => self.start_calibration(at_ps, true),
            Action::Write {
                address,
                value,
                last,
            } => {
                self.registers.set(address, value);
                if last && !self.standby {
                    self.restart(at_ps);
                }
            }
        }
    }

    /// Empties the filter and starts it again.
    fn restart(&mut self, at_ps: u64) {
        self.calibration = None;
        self.conversion.restart();
        self.timeline.restart(at_ps, &self.registers);
    }

    /// RESET, by command or by the supply.
    fn reset(&mut self, at_ps: u64) {
        self.registers.reset();
        self.decoder.reset();
        // The opcode acts at the last bit of the byte as the part counts: a slip outlives it.
        self.serial.clear();
        self.mode = self.mode_after_reset;
        self.requested = false;
        self.standby = false;
        self.synced_ps = None;
        self.drdy_dead = false;
        self.stuck = None;
        self.excused = false;
        self.restart(at_ps);
    }

    /// A SYNC command, or a rising edge on the SYNC pin.
    ///
    /// In continuous-sync mode a SYNC that comes a whole number of conversions (within a clock)
    /// after the last one changes nothing.
    pub(crate) fn sync(&mut self, at_ps: u64) {
        if self.standby {
            return;
        }
        if let Some(synced_ps) = self.synced_ps.filter(|_| self.registers.continuous_sync()) {
            let period_ps = self.timeline.period_ps();
            let phase_ps = (at_ps - synced_ps) % period_ps;
            if phase_ps.min(period_ps - phase_ps) <= clocks_ps(1) {
                return;
            }
        }
        self.synced_ps = Some(at_ps);
        self.restart(at_ps);
    }

    fn breach(&mut self, at_ps: u64, rule: Rule) {
        // What a slip makes of a command is no fault of who sent it.
        if self.serial.slip.is_some() || rule == Rule::NotStopped && self.excused {
            return;
        }
        self.breach.get_or_insert((at_ps, rule));
    }
}
