//! Between timer ticks and data periods.

use ads1281::UPDATE_LEAD_NS;
use inm_protocol::{AXES, Settings};

use crate::Board;
use crate::converters::conversions_hz;

/// Time base of a stream: the board's timer and the data rate in force.
///
/// The timer and the converters run from different oscillators: two crystals, 50 ppm each, or the
/// chip's own instead of the board's crystal, which is good to 1 % only. So the length of a data
/// period is learned from the stamps of the stream, and the count of periods between two stamps is
/// right for gaps of up to 2000 periods in either case.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    timer_hz: u64,
    conversions_hz: u64,
    /// Seven and nine eighths of a data period, ticks: the next conversion comes between.
    earliest: u64,
    latest: u64,
    /// A data period as learned from the stamps, ticks with [`FRACTION`] bits.
    period: u64,
    /// Intervals that it is the mean of, up to [`MEMORY`].
    learned: u64,
    /// From SYNC to the first edge when it was first seen, ticks; 0 before.
    first_settling: u64,
    /// The same in data periods with [`FRACTION`] bits, once their length is learned; 0 before. The
    /// shortest seen: what restarts a converter behind SYNC makes it late.
    settling: u64,
    /// Latest start of the reading of one word after its stamp, ticks.
    latest_reading: u64,
    /// Latest start of a register check after its stamp, ticks.
    latest_check: u64,
}

/// Fraction bits of the period: what rounding leaves of it, 2^-8 of a tick, is 2e-5 of the shortest
/// period of a timer of 1 MHz.
const FRACTION: u32 = 16;

/// Intervals that the mean of a period forgets over: of stamps that are good to a tick of 250, a
/// sixteenth remains, 2e-4 of a period.
const MEMORY: u64 = 1 << FORGET;
const FORGET: u32 = 8;

/// By how much SYNC, the first edge behind it and their stamps may be apart from one time to the next,
/// microseconds: two interrupts of 1 us that come between, and the converter's clock of 0.25 us. A
/// thirty-second of a period comes on top, for 63 periods of a length that is good to 2e-4.
const STEP_US: u32 = 5;

/// What lies between two edges of X's DRDY.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Interval {
    /// Less than a data period: X converts faster than it was told.
    Early,
    /// One data period.
    Next,
    /// Anything else; data periods, to the nearest.
    Gap { periods: u64 },
}

impl Clock {
    /// Time of the program around a word or a check, and the 4 converter clocks by which it has
    /// to end before the next conversion, microseconds.
    const OVERHEAD_US: u64 = 5;
    /// Bytes of a register check, and the gap with each, nanoseconds.
    const CHECK_BYTES: u64 = 5;
    const CHECK_GAPS_NS: u64 = 6 * ads1281::GAP_NS as u64;

    pub(super) fn new(board: &Board, settings: Settings) -> Self {
        let timer_hz = u64::from(board.timer_hz.max(1));
        let spi_hz = u64::from(board.spi_hz.max(1));
        let conversions_hz = u64::from(conversions_hz(settings));
        let period = timer_hz / conversions_hz;
        let overhead = Self::OVERHEAD_US * timer_hz / 1_000_000 + 1;
        let reading = 32 * timer_hz / spi_hz + overhead;
        let check = 8 * Self::CHECK_BYTES * timer_hz / spi_hz
            + Self::CHECK_GAPS_NS * timer_hz / 1_000_000_000
            + overhead;
        Self {
            timer_hz,
            conversions_hz,
            earliest: period - period / 8,
            latest: period + period / 8 + 1,
            period: (timer_hz << FRACTION) / conversions_hz,
            learned: 0,
            first_settling: 0,
            settling: 0,
            latest_reading: period.saturating_sub(reading),
            latest_check: period.saturating_sub(check),
        }
    }

    /// Ticks of that many data periods.
    pub(super) fn periods(&self, count: u32) -> u64 {
        u64::from(count) * self.timer_hz / self.conversions_hz
    }

    /// Ticks of that many microseconds, rounded up.
    pub(super) fn micros(&self, count: u32) -> u64 {
        (u64::from(count) * self.timer_hz).div_ceil(1_000_000)
    }

    /// What lies between two stamps, one later than the other.
    #[inline]
    pub(super) fn between(&self, earlier: u64, later: u64) -> Interval {
        let ticks = later.saturating_sub(earlier);
        if ticks < self.earliest {
            Interval::Early
        } else if ticks <= self.latest {
            Interval::Next
        } else {
            // 64 bits hold 19 days at 84 MHz; what is longer is as long as that.
            let ticks = ticks.min(u64::MAX >> (FRACTION + 1)) << FRACTION;
            let periods = (ticks + self.period / 2) / self.period;
            Interval::Gap { periods }
        }
    }

    /// Learns from two stamps with [`Interval::Next`] between them.
    #[inline]
    pub(super) fn learn(&mut self, earlier: u64, later: u64) {
        let ticks = later.saturating_sub(earlier) << FRACTION;
        if self.learned < MEMORY {
            self.learned += 1;
            self.period = (self.period * (self.learned - 1) + ticks) / self.learned;
            if self.learned == MEMORY {
                self.settling = self.in_periods(self.first_settling);
            }
        } else {
            self.period = self.period - (self.period >> FORGET) + (ticks >> FORGET);
        }
    }

    fn in_periods(&self, ticks: u64) -> u64 {
        (ticks << (2 * FRACTION)) / self.period
    }

    /// Whether the first edge after SYNC, so many ticks behind it, is where it was before, or whole
    /// periods later: a converter that was restarted since is out of step with the others. True
    /// while that is not known.
    #[cold]
    pub(super) fn is_in_step(&mut self, ticks: u64) -> bool {
        if self.first_settling == 0 {
            self.first_settling = ticks;
        }
        if self.settling == 0 {
            return true;
        }
        let period = self.period >> FRACTION;
        let slack = period / 32 + self.micros(STEP_US);
        let expected = (self.settling * self.period) >> (2 * FRACTION);
        if ticks + slack < expected {
            self.settling = self.in_periods(ticks);
            return true;
        }
        (ticks + slack - expected) % period <= 2 * slack
    }

    /// Whether a word can be read before the next conversion ends.
    pub(super) fn in_time_to_read(&self, stamp: u64, now: u64) -> bool {
        now.saturating_sub(stamp) <= self.latest_reading
    }

    /// Whether a register can be read back before the next conversion ends.
    pub(super) fn in_time_to_check(&self, stamp: u64, now: u64) -> bool {
        now.saturating_sub(stamp) <= self.latest_check
    }
}

/// Conversions a second of which three words can be read, one after the other, at `spi_hz`.
pub(super) fn readable_hz(spi_hz: u32) -> u32 {
    let word_ns = 32_000_000_000 / u64::from(spi_hz.max(1)) + u64::from(UPDATE_LEAD_NS);
    (1_000_000_000 / (AXES as u64 * word_ns)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use inm_protocol::{Filter, Rate};

    fn clock(timer_hz: u32, rate: Rate) -> Clock {
        let board = Board {
            platform: "test",
            serial: [0; 3],
            timer_hz,
            spi_hz: 1_312_500,
            baud: 921_600,
            range: inm_protocol::SensorRange::G4,
            reference_uv: 5_000_000,
            sensor_supply_uv: 2_800_000,
            restart: inm_protocol::Restart::Power,
        };
        let filter = Filter::default();
        Clock::new(&board, Settings { rate, filter })
    }

    #[test]
    fn intervals_are_told_apart_at_any_timer_and_rate() {
        for timer_hz in [100_000, 1_000_000, 84_000_000, 1_000_000_000] {
            for rate in Rate::ALL {
                let clock = clock(timer_hz, rate);
                let period = u64::from(timer_hz / rate.hz());
                let between = |ticks| clock.between(1000, 1000 + ticks);
                assert_eq!(between(0), Interval::Early);
                assert_eq!(between(period * 3 / 4), Interval::Early);
                // A tick of jitter and 100 ppm of either crystal.
                for ticks in [period - 1 - period / 10_000, period + 1 + period / 10_000] {
                    assert_eq!(between(ticks), Interval::Next);
                }
                for periods in [2, 63, 5000] {
                    let late = periods * period + periods * period / 20_000;
                    assert_eq!(between(late), Interval::Gap { periods });
                }
                assert_eq!(between(period * 5 / 4), Interval::Gap { periods: 1 });
            }
        }
    }

    /// The chip's own oscillator is good to 1 %: half a period in fifty.
    #[test]
    fn long_gaps_are_counted_right_on_the_internal_oscillator() {
        for timer_hz in [1_000_000, 84_000_000] {
            for rate in Rate::ALL {
                for per_mille in [990, 1000, 1010] {
                    let mut clock = clock(timer_hz, rate);
                    let at = |index: u64| {
                        let ticks = u64::from(timer_hz) * per_mille / 1000;
                        1_000_000 + index * ticks / u64::from(rate.hz())
                    };
                    for index in 0..8000 {
                        let interval = clock.between(at(index), at(index + 1));
                        assert_eq!(interval, Interval::Next);
                        clock.learn(at(index), at(index + 1));
                        // The first recovery may come soon.
                        if index == 99 {
                            let gap = clock.between(at(100), at(163));
                            assert_eq!(gap, Interval::Gap { periods: 63 });
                        }
                    }
                    for periods in [2, 51, 63, 200, 500, 2000] {
                        assert_eq!(
                            clock.between(at(8000), at(8000 + periods)),
                            Interval::Gap { periods },
                            "{timer_hz} Hz, {rate:?}, {per_mille} per mille"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn three_words_fit_every_period() {
        for rate in Rate::ALL {
            let clock = clock(1_000_000, rate);
            // 24.4 us a word: the third starts 50 us after the edge, and whatever it took to get
            // there.
            assert!(clock.in_time_to_read(0, 150), "{rate:?}");
            let period = 1_000_000 / u64::from(rate.hz());
            assert!(!clock.in_time_to_read(0, period - 24), "{rate:?}");
            // A check after them: 30 us of bits, 35 us of gaps.
            assert!(clock.in_time_to_check(0, 80 + 20), "{rate:?}");
        }
        assert_eq!(readable_hz(1_312_500), 13_144);
    }
}
