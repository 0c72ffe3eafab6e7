//! Between timer ticks and data periods.

use inm_protocol::Settings;

use crate::Board;
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
    /// One and a half data periods, ticks.
    next: u64,
    /// Latest start of a reading of all axes after its stamp, ticks.
    latest_reading: u64,
    /// Latest start of a register check after its stamp, ticks.
    latest_check: u64,
}

impl Clock {
    /// Time for a word on each axis and the program around it, beyond the bits, microseconds.
    const READING_OVERHEAD_US: u64 = 5;
    /// Bytes of a register check, and the gap with each, nanoseconds.
    const CHECK_BYTES: u64 = 5;
    const CHECK_GAPS_NS: u64 = 6 * crate::ads1281::GAP_NS as u64;

    pub(super) fn new(board: &Board, settings: Settings) -> Self {
        let timer_hz = u64::from(board.timer_hz.max(1));
        let spi_hz = u64::from(board.spi_hz.max(1));
        let conversions_hz = u64::from(conversions_hz(settings));
        let period = timer_hz / conversions_hz;
        let word_ticks = 32 * timer_hz / spi_hz + 1;
        let overhead = Self::READING_OVERHEAD_US * timer_hz / 1_000_000 + 1;
        let reading = 3 * word_ticks + overhead;
        let check = 8 * Self::CHECK_BYTES * timer_hz / spi_hz
            + Self::CHECK_GAPS_NS * timer_hz / 1_000_000_000
            + overhead;
        Self {
            timer_hz,
            conversions_hz,
            next: period + period / 2,
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

    /// Data periods from one stamp to a later one, to the nearest; 0 for less than half.
    pub(super) fn between(&self, earlier: u64, later: u64) -> u64 {
        let ticks = later.saturating_sub(earlier);
        if 2 * ticks >= self.next && ticks < self.next {
            return 1;
        }
        (ticks * self.conversions_hz + self.timer_hz / 2) / self.timer_hz
    }

    /// Whether all axes can be read before the next conversion ends.
    pub(super) fn in_time_to_read(&self, stamp: u64, now: u64) -> bool {
        now.saturating_sub(stamp) <= self.latest_reading
    }

    /// Whether a register can be read back before the next conversion ends.
    pub(super) fn in_time_to_check(&self, stamp: u64, now: u64) -> bool {
        now.saturating_sub(stamp) <= self.latest_check
    }
}

/// Conversions a second of which one bus at `spi_hz` after the other can read three words, and
/// be done four converter clocks before the next (SBAS378D, page 24).
pub(super) fn readable_hz(spi_hz: u32) -> u32 {
    const DEADLINE_NS: u64 = 977;
    let reading_ns = 96_000_000_000 / u64::from(spi_hz.max(1));
    (1_000_000_000 / (reading_ns + DEADLINE_NS)) as u32
}
