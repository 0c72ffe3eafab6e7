//! The chip in time: what is due happens, and what follows from it is worked out.

use super::gpio::Mode;
use super::rcc::Cause;
use super::spi::Spi;
use super::{Chip, EXTI4, EXTI9_5, PORT_C, READY_LINES, REFERENCE_CODE, Stop, USART1};
use crate::board::{ANALOG_SUPPLY_MV, SENSOR_SUPPLY_MV};

/// Cycles of an instruction, as a fraction: what docs/studies/board.md assumes.
const CYCLES: (u64, u64) = (3, 2);

const PS_PER_S: u64 = 1_000_000_000_000;

/// SCLK, DOUT, DIN of X, Y, Z: port, pins, alternate function (STM32F405 data sheet, table 9).
const BUSES: [(usize, [u32; 3], u32); 3] = [
    (0, [5, 6, 7], 5),
    (1, [13, 14, 15], 5),
    (2, [10, 11, 12], 6),
];

/// What the sensor says now: 40 degC and a bit.
const TEMPERATURE_CODE: u32 = 973;

impl Chip {
    /// So many instructions are executed from now on.
    pub(crate) fn spend(&mut self, instructions: u64) {
        self.now_ps += instructions * self.ps_per_instruction;
        self.spent.instructions += instructions;
        if !self.core.in_thread() {
            self.spent.in_handlers += instructions;
        }
    }

    /// Lets everything happen that is due, if something is.
    pub(crate) fn catch_up_if_due(&mut self) {
        if self.now_ps >= self.due_ps {
            self.catch_up();
        }
    }

    /// Skips to what next happens; what was skipped.
    pub(crate) fn skip(&mut self) -> u64 {
        let skipped = self.due_ps.saturating_sub(self.now_ps);
        self.now_ps += skipped;
        self.catch_up();
        skipped
    }

    /// Lets everything happen that is due.
    fn catch_up(&mut self) {
        let (now_ps, clocks) = (self.now_ps, self.rcc.clocks);
        let held = self.input_is_held();
        for axis in 0..3 {
            if self.board.takes_edge(now_ps, axis) {
                self.fall(axis);
            }
            self.spi[axis].catch_up(now_ps);
        }
        let supply = self.gpio[PORT_C as usize].pin(0).mode == Mode::Analog;
        self.adc.catch_up(now_ps, |channel| code(channel, supply));
        self.usart.catch_up(now_ps, clocks.pclk2, held);
        while let Some(edge_ps) = self.board.pulses.pop_front_if(|edge_ps| *edge_ps <= now_ps) {
            // PA0, TIM2_CH1.
            if self.gpio[0].pin(0).mode == Mode::Alternate(1) {
                self.timer.edge(edge_ps, clocks.timclk1);
            }
        }
        self.core.catch_up(now_ps, clocks.hclk);
        if self.watchdog.bites_ps().is_some_and(|at| at <= now_ps) {
            self.stop = Some(Stop::Reset(Cause::Watchdog));
        } else if now_ps >= self.deadline_ps {
            self.stop.get_or_insert(Stop::Deadline);
        }
        self.settle();
    }

    /// DRDY of an axis falls.
    pub(super) fn fall(&mut self, axis: usize) {
        self.edges[axis] += 1;
        self.exti.fall(PORT_C, READY_LINES[axis]);
    }

    /// Works out what follows from the state: bytes that begin, lines, what happens next.
    pub(crate) fn settle(&mut self) {
        for axis in 0..3 {
            if let Some(din) = self.spi[axis].take_waiting() {
                self.clock(axis, din);
            }
        }
        self.core.line(EXTI4, self.exti.asks(1 << 4));
        self.core.line(EXTI9_5, self.exti.asks(0b11111 << 5));
        self.core.line(USART1, self.usart.asks());
        self.attention = self.core.wakes();
        let (cycles, per) = CYCLES;
        self.ps_per_instruction = match self.rcc.clocks.hclk {
            0 => {
                self.stop.get_or_insert(Stop::NoClock);
                0
            }
            hclk => cycles * PS_PER_S / per / hclk,
        };
        let spi = self.spi.iter().filter_map(Spi::next_ps);
        let board = [0, 1, 2].into_iter().filter_map(|x| self.board.next_ps(x));
        let others = [
            self.usart.next_ps(self.input_is_held()),
            self.adc.next_ps(),
            self.core.next_ps(),
            self.watchdog.bites_ps(),
            self.board.pulses.front().copied(),
            Some(self.deadline_ps),
        ];
        let all = spi.chain(board).chain(others.into_iter().flatten());
        self.due_ps = all.min().unwrap_or(u64::MAX);
    }

    /// A byte goes out on a bus now, if its pins are what the board has connected.
    fn clock(&mut self, axis: usize, din: u8) {
        let (port, pins, function) = BUSES[axis];
        let wired = |pin: &u32| self.gpio[port].pin(*pin).mode == Mode::Alternate(function);
        if !pins.iter().all(wired) || !self.spi[axis].suits() {
            self.misuse
                .insert(format!("SPI {axis} clocked while it is not set up"));
        }
        let sclk_hz = self.sclk_hz(axis);
        let (end_ps, dout) = self.board.clock(self.now_ps, axis, sclk_hz, din);
        self.spi[axis].shift(end_ps, dout);
    }
}

/// Code of a channel of the chip's converter: 10 is PC0, 16 the temperature, 17 the reference.
fn code(channel: u32, supply_is_connected: bool) -> u32 {
    match channel {
        10 if supply_is_connected => SENSOR_SUPPLY_MV / 2 * 4095 / ANALOG_SUPPLY_MV,
        16 => TEMPERATURE_CODE,
        17 => u32::from(REFERENCE_CODE),
        _ => 0,
    }
}
