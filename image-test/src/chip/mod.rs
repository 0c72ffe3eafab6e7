//! The chip: peripherals in time, between the core and the board.
//!
//! Time goes on in two ways only: instructions take some, and a sleep or a wait skips to what happens
//! next. Peripherals are brought up to now before anybody looks at them.

pub mod adc;
pub mod core;
pub mod exti;
pub mod gpio;
pub mod map;
pub mod rcc;
pub mod spi;
pub mod timer;
pub mod usart;
pub mod watchdog;

use std::collections::BTreeSet;

use crate::board::{ANALOG_SUPPLY_MV, Board, SENSOR_SUPPLY_MV};
use adc::Adc;
use core::Core;
use exti::Exti;
use gpio::{Gpio, Mode, Pull};
use rcc::{Cause, Rcc};
use spi::Spi;
use timer::Timer;
use usart::{Line, Usart};
use watchdog::Watchdog;

/// Cycles of an instruction, as a fraction: what docs/studies/board.md assumes.
const CYCLES: (u64, u64) = (3, 2);

const PS_PER_S: u64 = 1_000_000_000_000;

/// Interrupts of the image, by their places among the vectors (RM0090, 12.2): line 4 of EXTI.
pub const EXTI4: usize = 10;
/// Lines 5 to 9.
pub const EXTI9_5: usize = 23;
/// The link.
pub const USART1: usize = 37;

/// DRDY of X, Y, Z: lines 4, 5, 6, on port C.
const READY_LINES: [u32; 3] = [4, 5, 6];
const PORT_C: u32 = 2;

/// SCLK, DOUT, DIN of X, Y, Z: port, pins, alternate function (STM32F405 data sheet, table 9).
const BUSES: [(usize, [u32; 3], u32); 3] = [
    (0, [5, 6, 7], 5),
    (1, [13, 14, 15], 5),
    (2, [10, 11, 12], 6),
];

/// Factory codes at 3.3 V (STM32F405 data sheet): of the reference, and of the temperature sensor at
/// 30 and 110 degC.
pub const REFERENCE_CODE: u16 = 1502;
/// At 30 degC.
pub const COLD_CODE: u16 = 940;
/// At 110 degC.
pub const HOT_CODE: u16 = 1200;
/// What the sensor says now: 40 degC and a bit.
const TEMPERATURE_CODE: u32 = 973;

/// Registers of a peripheral that only keep what is written, by offset.
#[derive(Clone)]
struct Registers([u32; 1024]);

impl Default for Registers {
    fn default() -> Self {
        Self([0; 1024])
    }
}

impl Registers {
    fn get(&self, offset: u32) -> u32 {
        self.0[(offset / 4) as usize]
    }

    fn set(&mut self, offset: u32, value: u32) {
        self.0[(offset / 4) as usize] = value;
    }
}

/// Why the machine does not go on as it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The time that was asked for is over.
    Deadline,
    /// The chip is reset.
    Reset(Cause),
    /// The core has no clock.
    NoClock,
}

/// Where the time went.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spent {
    /// Instructions, without those of waits that were skipped.
    pub instructions: u64,
    /// Of them, those of handlers.
    pub in_handlers: u64,
    /// Asleep, picoseconds.
    pub asleep_ps: u64,
    /// Looking again and again at a bus, picoseconds.
    pub waiting_ps: u64,
}

/// The chip.
pub struct Chip {
    /// Since power-on, picoseconds.
    pub now_ps: u64,
    /// Clocks and resets.
    pub rcc: Rcc,
    /// Wait states of the flash.
    flash: Registers,
    /// Ports A, B, C.
    pub gpio: [Gpio; 3],
    exti: Exti,
    /// SPI1 to SPI3: X, Y, Z.
    pub spi: [Spi; 3],
    timer: Timer,
    /// The link.
    pub usart: Usart,
    /// The chip's converter.
    pub adc: Adc,
    /// The watchdog.
    pub watchdog: Watchdog,
    /// NVIC and SysTick.
    pub core: Core,
    /// What is around the chip.
    pub board: Board,
    /// What the image did that the manual forbids.
    pub misuse: BTreeSet<String>,
    /// Where the time went.
    pub spent: Spent,
    /// Falling edges of DRDY so far, X, Y, Z.
    pub edges: [u64; 3],
    /// An edge of X that a test has come in the middle of its handler: at its next look at the time.
    pub edge_at_next_stamp: bool,
    /// Why the machine stops, once.
    pub(crate) stop: Option<Stop>,
    /// No further than this.
    pub(crate) deadline_ps: u64,
    /// What next happens.
    due_ps: u64,
    /// An exception waits.
    pub(crate) attention: bool,
    /// The last register that was read, and what it said.
    looked: Option<(u32, u32)>,
    ps_per_instruction: u64,
}

impl Chip {
    /// At power-on.
    #[must_use]
    pub fn new(board: Board) -> Self {
        let rcc = Rcc::new(board.crystal, 0, Cause::Power);
        let mut chip = Self::fresh(board, rcc, Line::default());
        chip.settle();
        chip
    }

    fn fresh(board: Board, rcc: Rcc, line: Line) -> Self {
        Self {
            now_ps: 0,
            rcc,
            flash: Registers::default(),
            gpio: [0, 1, 2].map(Gpio::new),
            exti: Exti::default(),
            spi: Default::default(),
            timer: Timer::default(),
            usart: Usart::new(line),
            adc: Adc::default(),
            watchdog: Watchdog::new(),
            core: Core::new(),
            board,
            misuse: BTreeSet::new(),
            spent: Spent::default(),
            edges: [0; 3],
            edge_at_next_stamp: false,
            stop: None,
            deadline_ps: 0,
            due_ps: 0,
            attention: false,
            looked: None,
            ps_per_instruction: 0,
        }
    }

    /// All that a reset does not reach stays: time, the board, the line, what was noted.
    pub(crate) fn reset(self, cause: Cause) -> Self {
        let rcc = Rcc::new(self.board.crystal, self.rcc.flags(), cause);
        let mut chip = Self {
            now_ps: self.now_ps,
            misuse: self.misuse,
            spent: self.spent,
            deadline_ps: self.deadline_ps,
            ..Self::fresh(self.board, rcc, self.usart.line)
        };
        chip.settle();
        chip
    }

    /// Lets the crystal swing, or stops it.
    pub fn set_crystal(&mut self, swings: bool) {
        self.board.crystal = swings;
        self.rcc.set_crystal(swings);
        self.settle();
    }

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
        self.core.catch_up(now_ps, clocks.hclk);
        if self.watchdog.bites_ps().is_some_and(|at| at <= now_ps) {
            self.stop = Some(Stop::Reset(Cause::Watchdog));
        } else if now_ps >= self.deadline_ps {
            self.stop.get_or_insert(Stop::Deadline);
        }
        self.settle();
    }

    /// DRDY of an axis falls.
    fn fall(&mut self, axis: usize) {
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

    /// SCLK of an axis, hertz: SPI1 is on the faster bus.
    #[must_use]
    pub fn sclk_hz(&self, axis: usize) -> u64 {
        let clocks = self.rcc.clocks;
        let pclk = if axis == 0 {
            clocks.pclk2
        } else {
            clocks.pclk1
        };
        self.spi[axis].sclk_hz(pclk)
    }

    /// Whether the host's line, PA10, rests high when nobody is connected.
    fn input_is_held(&self) -> bool {
        self.gpio[0].pin(10).pull == Pull::Up
    }

    /// Writes a register of the core.
    pub(crate) fn control(&mut self, offset: u32, size: u32, value: u32) {
        let (now_ps, hclk) = (self.now_ps, self.rcc.clocks.hclk);
        self.core.write(offset, size, value, now_ps, hclk);
        if self.core.reset_requested {
            self.stop = Some(Stop::Reset(Cause::Software));
        }
        self.settle();
    }

    /// Wait states of the flash (RM0090, 3.9.1).
    #[must_use]
    pub fn wait_states(&self) -> u32 {
        self.flash.get(0) & 15
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
