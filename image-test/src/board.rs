//! What is soldered to the chip: converters, crystal, accelerometers' supply, the host's cable.

use std::collections::VecDeque;

use embedded_hal::digital::{InputPin as _, OutputPin as _};
use embedded_hal::spi::SpiBus as _;
use inm_emulator::{Bench, Converter};

use crate::record::Record;

/// A byte on a bus.
#[derive(Debug, Clone, Copy)]
pub struct Byte {
    /// The axis.
    pub axis: usize,
    /// To the converter.
    pub din: u8,
    /// When SCLK's first period began.
    pub begin_ps: u64,
    /// SCLK's period.
    pub bit_ps: u64,
}

impl Byte {
    /// From its last rising edge of SCLK, in the middle of a period, to the first of the next byte.
    #[must_use]
    pub fn gap_ps(&self, next: &Self) -> u64 {
        let last = self.begin_ps + 7 * self.bit_ps + self.bit_ps / 2;
        next.begin_ps + next.bit_ps / 2 - last
    }
}

/// The converters' bench on the pins of the chip.
pub struct Board {
    /// Whether the crystal swings.
    pub crystal: bool,
    /// The converters; rules of the part that the image breaks are in its `violation`.
    pub bench: Bench<Record>,
    /// Bytes on the buses, where a test has asked for them.
    pub bytes: Option<Vec<Byte>>,
    /// Rising edges to come at the input for a pulse a second, ascending, picoseconds since power-on.
    pub pulses: VecDeque<u64>,
    /// By axis: the latest falling edge of DRDY that EXTI was told of.
    told_ps: [Option<u64>; 3],
}

impl Board {
    /// Powered up now.
    #[must_use]
    pub fn new(crystal: bool) -> Self {
        let bench = Bench::new([0, 1, 2].map(|axis| Converter::new(Record::new(axis))));
        // A panic within the engine's callbacks would end the process: the tests look themselves.
        bench.set_strict(false);
        Self {
            crystal,
            bench,
            bytes: None,
            pulses: VecDeque::new(),
            told_ps: [None; 3],
        }
    }

    /// Brings the converters up to `now_ps`. They may be ahead, by the byte under way.
    fn catch_up(&self, now_ps: u64) {
        let behind_ps = now_ps.saturating_sub(self.bench.now_ps());
        self.bench.advance_ps(behind_ps);
    }

    /// Clocks a byte through the converter of an axis from `now_ps` on: its end, and DOUT.
    pub fn clock(&mut self, now_ps: u64, axis: usize, sclk_hz: u64, din: u8) -> (u64, u8) {
        self.catch_up(now_ps);
        self.bench.set_sclk_hz(axis, sclk_hz as u32);
        let begin_ps = self.bench.now_ps();
        let mut byte = [din];
        // The only error is one that a test would have to inject.
        let _ = self.bench.spi(axis).transfer_in_place(&mut byte);
        if let Some(bytes) = &mut self.bytes {
            bytes.push(Byte {
                axis,
                din,
                begin_ps,
                bit_ps: (self.bench.now_ps() - begin_ps) / 8,
            });
        }
        (self.bench.now_ps(), byte[0])
    }

    /// Sets the level of SYNC.
    pub fn set_sync(&mut self, now_ps: u64, high: bool) {
        self.catch_up(now_ps);
        // Cannot fail.
        let _ = self.bench.sync().set_state(high.into());
    }

    /// Whether DRDY of an axis is high.
    #[must_use]
    pub fn ready_is_high(&self, now_ps: u64, axis: usize) -> bool {
        self.catch_up(now_ps);
        self.bench.drdy(axis).is_high().unwrap_or(true)
    }

    /// When something next happens at the converter of an axis: an edge that has not been told yet,
    /// or whatever it does by itself.
    #[must_use]
    pub fn next_ps(&self, axis: usize) -> Option<u64> {
        let edge_ps = self.bench.last_edge_ps(axis);
        if edge_ps > self.told_ps[axis] {
            return edge_ps;
        }
        self.bench.next_change_ps(axis)
    }

    /// Whether DRDY of an axis has fallen since the last call.
    pub fn takes_edge(&mut self, now_ps: u64, axis: usize) -> bool {
        self.catch_up(now_ps);
        let edge_ps = self.bench.last_edge_ps(axis);
        let new = edge_ps > self.told_ps[axis] && edge_ps <= Some(now_ps);
        if new {
            self.told_ps[axis] = edge_ps;
        }
        new
    }
}

/// Supply of the accelerometers, millivolts, which the board halves for the chip's converter.
pub const SENSOR_SUPPLY_MV: u32 = 2800;

/// Supply of the chip's converter, millivolts.
pub const ANALOG_SUPPLY_MV: u32 = 3300;
