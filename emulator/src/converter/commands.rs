//! What a command, RESET and SYNC do to a converter.

use super::{Converter, ReadMode};
use crate::{Signal, command::Action, time::clocks_ps};

impl<S: Signal> Converter<S> {
    pub(super) fn act(&mut self, action: Action, at_ps: u64) {
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
    pub(super) fn reset(&mut self, at_ps: u64) {
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
}
