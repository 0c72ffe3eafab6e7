//! Between timer ticks and data periods.

use inm_protocol::{AXES, Settings};

use crate::Board;
use crate::ads1281::UPDATE_LEAD_NS;
use crate::ads1281::config::conversions_hz;

/// Time base of a stream: the board's timer and the data rate in force.
///
/// The timer and the converters run from different crystals. Both may be off by 50 ppm, so
/// that the count of periods between two stamps is right for gaps of up to 5000 periods;
/// longer ones may be off by one in 10000.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    timer_hz: u64,
    conversions_hz: u64,
    /// Seven and nine eighths of a data period, ticks: the next conversion comes between.
    earliest: u64,
    latest: u64,
    /// Latest start of the reading of one word after its stamp, ticks.
    latest_reading: u64,
    /// Latest start of a register check after its stamp, ticks.
    latest_check: u64,
}

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
    const CHECK_GAPS_NS: u64 = 6 * crate::ads1281::GAP_NS as u64;

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
            let periods = (ticks * self.conversions_hz + self.timer_hz / 2) / self.timer_hz;
            Interval::Gap { periods }
        }
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
