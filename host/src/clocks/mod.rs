//! What the clocks of a record say of one another: the data rate by the board's timer, by the host's clock and by a
//! pulse a second, each with its uncertainty.
//!
//! ```text
//!   converters --DRDY--> stamps of the board's timer --health records--> clock of the host
//!                              |
//!                              +--capture <-- a pulse a second of a receiver, where there is one
//!        conversions a second of the timer   x   its seconds in one of the host's, or of the pulses'
//! ```
//!
//! What a clock counts against another is measured. What the last of them is off by is not: the host's, like
//! any crystal, is taken to be right to [`CRYSTALS`], less only where something disciplines it. A pulse a second is
//! taken to be right: it has a receiver behind it that knows the time.

mod line;
pub mod pairs;
pub mod pulses;
#[cfg(test)]
mod tests;

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

pub use line::{FEWEST, Pair, ratio};

/// Part of the rate that two sound crystals may differ by: some 50 parts in a million each.
pub const CRYSTALS: f64 = 1e-4;

/// Part of the rate that one sound crystal may be off by.
pub const CRYSTAL: f64 = CRYSTALS / 2.0;

/// Part by which the oscillator inside a microcontroller may be off.
pub const INTERNAL: f64 = 1e-2;

/// Share of the board's clock to the host's that is believed. The worst clock of a board is good to
/// [`INTERNAL`]; five times as far off are two clocks that do not count the same time, as that of a simulation
/// that runs as fast as it can.
const BELIEVED: std::ops::RangeInclusive<f64> = 0.95..=1.05;

/// Upper end of the 95 % interval, as a probability of Student's distribution.
const UPPER_END: f64 = 0.975;

/// A number that was measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard uncertainty, in the same unit.
    pub sd: f64,
    /// Degrees of freedom behind that.
    pub freedom: f64,
}

impl Measured {
    /// Half the interval that Student's law gives, up to this probability of its upper end (0.5 to 1).
    pub fn half(&self, upper_end: f64) -> Option<f64> {
        let law = StudentsT::new(0.0, 1.0, self.freedom).ok()?;
        Some(law.inverse_cdf(upper_end) * self.sd)
    }

    /// Half the 95 % interval.
    pub fn half_95(&self) -> Option<f64> {
        self.half(UPPER_END)
    }

    /// The product of two that have nothing to do with one another; degrees of freedom by
    /// Satterthwaite (1946).
    fn times(&self, other: &Self) -> Self {
        let value = self.value * other.value;
        let [one, two] = [self, other].map(|one| (one.sd / one.value).powi(2));
        let variance = one + two;
        let spread = one * one / self.freedom + two * two / other.freedom;
        let freedom = if spread > 0.0 {
            variance * variance / spread
        } else {
            self.freedom.min(other.freedom)
        };
        Self {
            value,
            sd: value * variance.sqrt(),
            freedom,
        }
    }
}

/// The data rate of a record by the clocks that were there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Clocks {
    /// Conversions a second by the board's timer, over the longest stretch without a gap.
    pub rate_by_board_hz: Measured,
    /// Seconds of the board's timer in one of the host's clock; `None` where the record does not say.
    pub board_over_host: Option<Measured>,
    /// Conversions a second by the host's clock: the product of the two.
    pub rate_by_host_hz: Option<Measured>,
    /// Seconds of the board's timer in one of a pulse a second; `None` where the board had none.
    pub board_over_pps: Option<Measured>,
    /// Conversions a second by the pulses: the product of this and that of the stamps.
    pub rate_by_pps_hz: Option<Measured>,
    /// Part by which a sound board's timer and the converters' clock may differ.
    #[serde(skip)]
    board_good_to: f64,
}

impl Clocks {
    /// What the stamps give, for a board whose own clock is good to `board_good_to` of its rate, what its seconds are in
    /// those of the host, and in those of a pulse a second.
    pub fn new(
        by_board_hz: Measured,
        board_good_to: f64,
        over_host: Option<Measured>,
        over_pps: Option<Measured>,
    ) -> Self {
        let believed = |ratio: &Measured| BELIEVED.contains(&ratio.value);
        let board_over_host = over_host.filter(believed);
        let board_over_pps = over_pps.filter(believed);
        Self {
            rate_by_board_hz: by_board_hz,
            board_over_host,
            rate_by_host_hz: board_over_host.map(|ratio| by_board_hz.times(&ratio)),
            board_over_pps,
            rate_by_pps_hz: board_over_pps.map(|ratio| by_board_hz.times(&ratio)),
            board_good_to,
        }
    }

    /// The rate by the best clock that there is, samples a second, and the part of it that this clock and a sound
    /// one of the converters may differ by: a pulse a second is right, so that only the converters' is left.
    pub fn best(&self) -> (Measured, f64) {
        let by = |rate: Option<Measured>, good_to| Some((rate?, good_to));
        let others = [
            by(self.rate_by_pps_hz, CRYSTAL),
            by(self.rate_by_host_hz, CRYSTALS),
        ];
        // A pair of clocks whose share is hardly known is no better than the board's own.
        let known = |(rate, _): &(Measured, f64)| self.excess_of(rate) < self.board_good_to;
        let best = others.into_iter().flatten().find(known);
        best.unwrap_or((self.rate_by_board_hz, self.board_good_to))
    }

    /// How uncertain a rate is in all, as a part of it.
    fn excess_of(&self, rate: &Measured) -> f64 {
        rate.half_95()
            .map_or(f64::INFINITY, |half| half / rate.value)
    }
}

/// Probability, at most, that a `rate` of clocks that are right to the part `good_to` comes out as far from
/// `nominal_hz` by its uncertainty alone.
pub fn p_value(rate: &Measured, nominal_hz: f64, good_to: f64) -> f64 {
    let beyond = (rate.value - nominal_hz).abs() - good_to * nominal_hz;
    match StudentsT::new(0.0, 1.0, rate.freedom) {
        Ok(law) if beyond > 0.0 => 2.0 * law.cdf(-beyond / rate.sd),
        _ => 1.0,
    }
}
