//! When words are made and how DRDY shows it (SBAS378D pages 21 and 24).
//!
//! A conversion has two moments: the output register is overwritten 4/fCLK ahead (*load*), then
//! DRDY falls (*fall*). DRDY rises at the first SCLK falling edge after it; without one it stays
//! low and pulses high between the next load and fall, so that every conversion has its falling
//! edge.

use crate::{
    Output, Registers,
    time::{UPDATE_LEAD_PS, period_ps, settling_ps},
};

/// Words that the sinc stage needs to settle: its order.
const SINC_SETTLING_WORDS: u64 = 5;

/// A moment in a conversion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moment {
    Load,
    Fall,
}

/// The conversions' course in time and the DRDY output.
#[derive(Debug, Clone, Default)]
pub(crate) struct Timeline {
    /// Next fall; `None` while the part does not convert.
    next_fall_ps: Option<u64>,
    loaded: bool,
    period_ps: u64,
    /// Words before this are zeros (continuous-sync) or never come (pulse-sync).
    settled_ps: u64,
    /// Last fall that the pin showed.
    fell_ps: Option<u64>,
    /// Falling edge seen and not yet taken, as in an interrupt controller.
    pub(crate) edge: bool,
    /// Last falling edge of SCLK.
    pub(crate) sclk_ps: u64,
}

impl Timeline {
    /// Starts conversions afresh at `at_ps`.
    pub(crate) fn restart(&mut self, at_ps: u64, registers: &Registers) {
        let period = period_ps(registers.word_rate_hz());
        self.period_ps = period;
        self.loaded = false;
        self.fell_ps = None;
        let settling = match registers.output() {
            Output::Modulator => {
                self.next_fall_ps = None;
                return;
            }
            Output::Sinc => SINC_SETTLING_WORDS * period,
            Output::Fir | Output::FirHighPass => settling_ps(period),
        };
        self.settled_ps = at_ps + settling;
        self.next_fall_ps = Some(if registers.continuous_sync() {
            let first = settling % period;
            at_ps + if first == 0 { period } else { first }
        } else {
            self.settled_ps
        });
    }

    /// Stops conversions.
    pub(crate) fn stop(&mut self) {
        self.next_fall_ps = None;
        self.hide();
    }

    /// Time of the next moment.
    pub(crate) fn next_ps(&self) -> Option<u64> {
        self.next_fall_ps.map(|fall| {
            if self.loaded {
                fall
            } else {
                fall - UPDATE_LEAD_PS
            }
        })
    }

    /// Takes the next moment if it has come by `now_ps`.
    pub(crate) fn take(&mut self, now_ps: u64) -> Option<(u64, Moment)> {
        let at = self.next_ps().filter(|&at| at <= now_ps)?;
        if self.loaded {
            self.next_fall_ps = Some(at + self.period_ps);
        }
        self.loaded = !self.loaded;
        Some((
            at,
            if self.loaded {
                Moment::Load
            } else {
                Moment::Fall
            },
        ))
    }

    /// Whether the filter has settled at the conversion whose load is at `load_ps`.
    pub(crate) fn settled(&self, load_ps: u64) -> bool {
        load_ps + UPDATE_LEAD_PS >= self.settled_ps
    }

    /// Shows a fall on the pin.
    pub(crate) fn fall(&mut self, at_ps: u64) {
        self.fell_ps = Some(at_ps);
        self.edge = true;
    }

    /// The pin goes high and shows no fall.
    pub(crate) fn hide(&mut self) {
        self.fell_ps = None;
    }

    /// Last fall that the pin showed.
    pub(crate) fn fell_ps(&self) -> Option<u64> {
        self.fell_ps
    }

    /// Level of the pin; every moment up to now has been taken.
    pub(crate) fn is_low(&self) -> bool {
        !self.loaded && self.fell_ps.is_some_and(|fell| self.sclk_ps <= fell)
    }

    /// Time between conversions.
    pub(crate) fn period_ps(&self) -> u64 {
        self.period_ps
    }
}
