//! EXTI and the part of SYSCFG that connects pins to it (RM0090, sections 12.3 and 9.2).

use super::Registers;

const IMR: u32 = 0x00;
const FTSR: u32 = 0x0c;
const PR: u32 = 0x14;

/// First of the four registers that name the port of each line (9.2.3).
const EXTICR1: u32 = 0x08;

/// The peripheral.
#[derive(Default)]
pub struct Exti {
    registers: Registers,
    ports: Registers,
}

impl Exti {
    /// Pin `line` of `port` (0 for A) falls.
    pub(super) fn fall(&mut self, port: u32, line: u32) {
        let chosen = self.ports.get(EXTICR1 + 4 * (line / 4)) >> (4 * (line % 4)) & 15;
        let falls = self.registers.get(FTSR) >> line & 1 != 0;
        if chosen == port && falls {
            let pending = self.registers.get(PR) | 1 << line;
            self.registers.set(PR, pending);
        }
    }

    /// Whether one of these lines asks for its interrupt.
    pub(super) fn asks(&self, lines: u32) -> bool {
        self.registers.get(PR) & self.registers.get(IMR) & lines != 0
    }

    pub(super) fn read(&self, offset: u32) -> u32 {
        self.registers.get(offset)
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) {
        // A one clears, a zero leaves (12.3.6).
        let value = if offset == PR {
            self.registers.get(PR) & !value
        } else {
            value
        };
        self.registers.set(offset, value);
    }

    pub(super) fn read_ports(&self, offset: u32) -> u32 {
        self.ports.get(offset)
    }

    pub(super) fn write_ports(&mut self, offset: u32, value: u32) {
        self.ports.set(offset, value);
    }
}
