//! Which register lies at which address (RM0090, 2.3), and what reading and writing it does.

use super::{Chip, PORT_C, READY_LINES, spi, timer};

/// Most that the chip's converter may be clocked by, hertz (STM32F405 data sheet, ADC characteristics).
pub const ADC_LIMIT_HZ: u64 = 36_000_000;

/// Bit-band alias of the peripherals: each word stands for a bit (PM0214, 2.2.5).
pub const BIT_BAND: u32 = 0x4200_0000;

/// The peripherals.
pub const PERIPHERALS: u32 = 0x4000_0000;

/// A peripheral that the image uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Block {
    Timer,
    Watchdog,
    Power,
    Spi(usize),
    Usart,
    Adc,
    Syscfg,
    Exti,
    Gpio(usize),
    Rcc,
    Flash,
}

/// Where a bit that lets a peripheral's clock run is: offset in RCC, bit (RM0090, 7.3.10 to 7.3.14).
type Enable = Option<(u32, u32)>;

const AHB1: u32 = 0x30;
const APB1: u32 = 0x40;
const APB2: u32 = 0x44;

const MAP: [(u32, Block, Enable); 15] = [
    (0x4000_0000, Block::Timer, Some((APB1, 0))),
    (0x4000_3000, Block::Watchdog, None),
    (0x4000_3800, Block::Spi(1), Some((APB1, 14))),
    (0x4000_3c00, Block::Spi(2), Some((APB1, 15))),
    (0x4000_7000, Block::Power, Some((APB1, 28))),
    (0x4001_1000, Block::Usart, Some((APB2, 4))),
    (0x4001_2000, Block::Adc, Some((APB2, 8))),
    (0x4001_3000, Block::Spi(0), Some((APB2, 12))),
    (0x4001_3800, Block::Syscfg, Some((APB2, 14))),
    (0x4001_3c00, Block::Exti, None),
    (0x4002_0000, Block::Gpio(0), Some((AHB1, 0))),
    (0x4002_0400, Block::Gpio(1), Some((AHB1, 1))),
    (0x4002_0800, Block::Gpio(2), Some((AHB1, 2))),
    (0x4002_3800, Block::Rcc, None),
    (0x4002_3c00, Block::Flash, None),
];

/// Length of a peripheral's registers.
const LENGTH: u32 = 0x400;

impl Chip {
    /// Reads a register of a peripheral.
    pub(crate) fn read(&mut self, address: u32) -> u32 {
        self.catch_up_if_due();
        let Some((block, offset)) = self.find(address) else {
            return 0;
        };
        let value = self.look(block, offset);
        self.wait(block, address, value);
        // Reading a data register says that it was read; nothing else changes by being looked at.
        if matches!(block, Block::Spi(_) | Block::Usart | Block::Adc) {
            self.settle();
        }
        value
    }

    fn look(&mut self, block: Block, offset: u32) -> u32 {
        let now_ps = self.now_ps;
        match block {
            Block::Timer => {
                if offset == timer::CNT && self.core.running() != 0 {
                    self.come_in_between();
                }
                let clock_hz = self.rcc.clocks.timclk1;
                self.timer.read(offset, now_ps, clock_hz)
            }
            Block::Watchdog => self.watchdog.read(offset),
            Block::Spi(axis) => self.spi[axis].read(offset),
            Block::Usart => self.usart.read(offset),
            Block::Adc => self.adc.read(offset),
            Block::Syscfg => self.exti.read_ports(offset),
            Block::Exti => self.exti.read(offset),
            Block::Gpio(port) => self.gpio[port].read(offset, self.levels(port)),
            Block::Rcc => self.rcc.read(offset, now_ps),
            Block::Flash => self.flash.get(offset),
            Block::Power => 0,
        }
    }

    /// An edge of X that a test has ordered, while its handler is at work.
    fn come_in_between(&mut self) {
        if std::mem::take(&mut self.edge_at_next_stamp) {
            self.fall(0);
            self.settle();
        }
    }

    /// A second look in a row at the status of a busy bus that has not changed: nothing will until
    /// something happens, so time skips there. What is skipped counts as waiting.
    fn wait(&mut self, block: Block, address: u32, value: u32) {
        let busy = match block {
            Block::Spi(axis) => self.spi[axis].next_ps(),
            Block::Adc => self.adc.next_ps(),
            _ => None,
        };
        if self.looked == Some((address, value)) && busy.is_some() {
            self.spent.waiting_ps += self.skip();
        }
        self.looked = Some((address, value));
    }

    /// Levels that others drive on the pins of a port.
    fn levels(&self, port: usize) -> u32 {
        if port != PORT_C as usize {
            return 0;
        }
        let levels = READY_LINES
            .iter()
            .enumerate()
            .map(|(axis, line)| u32::from(self.board.ready_is_high(self.now_ps, axis)) << line);
        levels.sum()
    }

    /// Writes a register of a peripheral.
    pub(crate) fn write(&mut self, address: u32, value: u32) {
        self.catch_up_if_due();
        self.looked = None;
        let Some((block, offset)) = self.find(address) else {
            return;
        };
        let (now_ps, pclk2) = (self.now_ps, self.rcc.clocks.pclk2);
        match block {
            Block::Timer => self.timer.write(offset, value, now_ps),
            Block::Watchdog => self.watchdog.write(offset, value, now_ps),
            Block::Spi(axis) => {
                if offset == spi::DR && self.spi[axis].read(8) & 2 == 0 {
                    self.note(format!("SPI {axis} written while its buffer is full"));
                }
                self.spi[axis].write(offset, value);
            }
            Block::Usart => self.usart.write(offset, value, now_ps, pclk2),
            Block::Adc => {
                self.adc.write(offset, value, now_ps, pclk2);
                self.check_adc();
            }
            Block::Syscfg => self.exti.write_ports(offset, value),
            Block::Exti => self.exti.write(offset, value),
            Block::Gpio(port) => self.drive(port, offset, value),
            Block::Rcc => {
                self.rcc.write(offset, value, now_ps);
                self.check_flash();
            }
            Block::Flash => {
                self.flash.set(offset, value);
                if self.flash.emptied_while_on {
                    self.note("the flash's data cache emptied while it is on".to_owned());
                }
            }
            Block::Power => {}
        }
        self.settle();
    }

    fn drive(&mut self, port: usize, offset: u32, value: u32) {
        self.gpio[port].write(offset, value);
        // PB0 is SYNC.
        if let (1, Some(high)) = (port, self.gpio[1].driven(0)) {
            self.board.set_sync(self.now_ps, high);
        }
    }

    /// Reads or writes a bit through its alias.
    pub(crate) fn read_bit(&mut self, offset: u32) -> u32 {
        let (address, bit) = banded(offset);
        self.read(address) >> bit & 1
    }

    /// See [`Self::read_bit`].
    pub(crate) fn write_bit(&mut self, offset: u32, value: u32) {
        let (address, bit) = banded(offset);
        let word = self.read(address) & !(1 << bit);
        self.write(address, word | (value & 1) << bit);
    }

    /// The peripheral at an address, and the register's offset in it.
    fn find(&mut self, address: u32) -> Option<(Block, u32)> {
        let found = MAP
            .iter()
            .find(|(base, ..)| (*base..base + LENGTH).contains(&address));
        let Some(&(base, block, enable)) = found else {
            self.note(format!("nothing known at {address:#010x}"));
            return None;
        };
        if enable.is_some_and(|bit| !self.rcc.enabled(bit)) {
            self.note(format!("{block:?} used while its clock is off"));
        }
        Some((block, (address - base) & !3))
    }

    fn check_adc(&mut self) {
        let adc_hz = self.adc.clock_hz(self.rcc.clocks.pclk2);
        if self.adc.next_ps().is_some() && adc_hz > ADC_LIMIT_HZ {
            self.note(format!("ADC converts at {adc_hz} Hz"));
        }
    }

    /// A wait state for each 30 MHz begun (RM0090, table 10, from 2.7 V).
    fn check_flash(&mut self) {
        let needed = self.rcc.clocks.hclk.div_ceil(30_000_000).saturating_sub(1);
        if u64::from(self.wait_states()) < needed {
            self.note(format!("{} wait states of {needed}", self.wait_states()));
        }
    }

    pub(crate) fn note(&mut self, what: String) {
        self.misuse.insert(what);
    }
}

/// Address and bit that an offset into the alias stands for.
fn banded(offset: u32) -> (u32, u32) {
    let byte = offset / 32;
    let (word, bit) = (byte & !3, 8 * (byte & 3) + offset % 32 / 4);
    (PERIPHERALS + word, bit)
}
