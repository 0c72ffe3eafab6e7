//! GPIO: modes, alternate functions, pulls and levels of a port (RM0090, section 8).

use super::Registers;

const MODER: u32 = 0x00;
const OTYPER: u32 = 0x04;
const PUPDR: u32 = 0x0c;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const AFRL: u32 = 0x20;
const AFRH: u32 = 0x24;

/// What a pin is used for (8.4.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Input.
    Input,
    /// Output.
    Output,
    /// Of a peripheral, by its number (8.4.9).
    Alternate(u32),
    /// Analog.
    Analog,
}

/// What holds an open pin (8.4.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pull {
    /// Nothing.
    None,
    /// A resistor to the supply.
    Up,
    /// A resistor to ground.
    Down,
}

/// How a pin is set up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pin {
    /// Its use.
    pub mode: Mode,
    /// Its pull.
    pub pull: Pull,
    /// Whether it drives high as well as low.
    pub push_pull: bool,
    /// Level that it drives where it is an output.
    pub high: bool,
}

/// A port.
pub struct Gpio {
    registers: Registers,
}

impl Gpio {
    /// Port A has the debug probe's pins at reset (8.3.1).
    pub(super) fn new(port: usize) -> Self {
        let mut registers = Registers::default();
        if port == 0 {
            registers.set(MODER, 0xa800_0000);
            registers.set(PUPDR, 0x6400_0000);
        } else if port == 1 {
            registers.set(MODER, 0x0000_0280);
            registers.set(PUPDR, 0x0000_0100);
        }
        Self { registers }
    }

    /// How a pin, 0 to 15, is set up.
    #[must_use]
    pub fn pin(&self, pin: u32) -> Pin {
        let pair = |offset| self.registers.get(offset) >> (2 * pin) & 0b11;
        let function = if pin < 8 { AFRL } else { AFRH };
        let function = self.registers.get(function) >> (4 * (pin % 8)) & 15;
        Pin {
            mode: match pair(MODER) {
                0 => Mode::Input,
                1 => Mode::Output,
                2 => Mode::Alternate(function),
                _ => Mode::Analog,
            },
            pull: match pair(PUPDR) {
                1 => Pull::Up,
                2 => Pull::Down,
                _ => Pull::None,
            },
            push_pull: self.registers.get(OTYPER) >> pin & 1 == 0,
            high: self.registers.get(ODR) >> pin & 1 != 0,
        }
    }

    /// Level that a pin drives; `None` where it is no output.
    #[must_use]
    pub fn driven(&self, pin: u32) -> Option<bool> {
        let pin = self.pin(pin);
        (pin.mode == Mode::Output).then_some(pin.high)
    }

    /// `levels` are those that others drive.
    pub(super) fn read(&self, offset: u32, levels: u32) -> u32 {
        match offset {
            IDR => {
                let driven = (0..16)
                    .filter_map(|pin| Some(u32::from(self.driven(pin)?) << pin))
                    .sum::<u32>();
                levels | driven
            }
            BSRR => 0,
            _ => self.registers.get(offset),
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) {
        match offset {
            BSRR => {
                // Setting wins over resetting (8.4.7).
                let odr = self.registers.get(ODR) & !(value >> 16) | value & 0xffff;
                self.registers.set(ODR, odr);
            }
            IDR => {}
            _ => self.registers.set(offset, value),
        }
    }
}
