//! The chip: peripherals in time, between the core and the board.
//!
//! Time goes on in two ways only: instructions take some, and a sleep or a wait skips to what happens
//! next. Peripherals are brought up to now before anybody looks at them.

pub mod adc;
pub mod core;
mod course;
pub mod exti;
pub mod flash;
pub mod gpio;
pub mod map;
pub mod rcc;
pub mod spi;
pub mod timer;
pub mod usart;
pub mod watchdog;

use std::collections::BTreeSet;

use crate::board::Board;
use adc::Adc;
use core::Core;
use exti::Exti;
use flash::Flash;
use gpio::{Gpio, Pull};
use rcc::{Cause, Rcc};
use spi::Spi;
use timer::Timer;
use usart::{Line, Usart};
use watchdog::Watchdog;

/// Interrupts of the image, by their places among the vectors (RM0090, 12.2): line 4 of EXTI.
pub const EXTI4: usize = 10;
/// Lines 5 to 9.
pub const EXTI9_5: usize = 23;
/// The link.
pub const USART1: usize = 37;

/// DRDY of X, Y, Z: lines 4, 5, 6, on port C.
const READY_LINES: [u32; 3] = [4, 5, 6];
const PORT_C: u32 = 2;

/// Factory codes at 3.3 V (STM32F405 data sheet): of the reference, and of the temperature sensor at
/// 30 and 110 degC.
pub const REFERENCE_CODE: u16 = 1502;
/// At 30 degC.
pub const COLD_CODE: u16 = 940;
/// At 110 degC.
pub const HOT_CODE: u16 = 1200;
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
    /// Wait states of the flash, erasing and programming.
    pub(crate) flash: Flash,
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
    /// What of APB1 a halted core stops.
    pub halted: u32,
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
        let mut chip = Self {
            now_ps: 0,
            rcc: Rcc::new(board.crystal, 0, Cause::Power),
            flash: Flash::new(),
            gpio: [0, 1, 2].map(Gpio::new),
            exti: Exti::default(),
            spi: Default::default(),
            timer: Timer::default(),
            usart: Usart::new(Line::default()),
            adc: Adc::default(),
            watchdog: Watchdog::new(),
            core: Core::new(),
            halted: 0,
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
        };
        chip.settle();
        chip
    }

    /// All that a reset does not reach stays: time, the board, the line, what was noted.
    pub(crate) fn reset(&mut self, cause: Cause) {
        let line = std::mem::take(&mut self.usart.line);
        self.rcc = Rcc::new(self.board.crystal, self.rcc.flags(), cause);
        self.flash = Flash::new();
        self.gpio = [0, 1, 2].map(Gpio::new);
        self.exti = Exti::default();
        self.spi = Default::default();
        self.timer = Timer::default();
        self.usart = Usart::new(line);
        self.adc = Adc::default();
        self.watchdog = Watchdog::new();
        self.core = Core::new();
        self.looked = None;
        self.settle();
    }

    /// Lets the crystal swing, or stops it.
    pub fn set_crystal(&mut self, swings: bool) {
        self.board.crystal = swings;
        self.rcc.set_crystal(swings);
        self.settle();
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

    /// The core stands still for so long; everything else goes on.
    pub(crate) fn stand_still(&mut self, ps: u64) {
        self.now_ps += ps;
        self.spent.waiting_ps += ps;
        self.catch_up_if_due();
    }

    /// Wait states of the flash (RM0090, 3.9.1).
    #[must_use]
    pub fn wait_states(&self) -> u32 {
        self.flash.get(0) & 15
    }
}
