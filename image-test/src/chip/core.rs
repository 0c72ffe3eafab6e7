//! The core's own registers: NVIC, SysTick, system control (PM0214, sections 4.3 to 4.5).

use super::Registers;

/// Number of the first interrupt among the exceptions (PM0214, 2.3.2).
pub const FIRST_INTERRUPT: usize = 16;
/// HardFault.
pub const HARD_FAULT: usize = 3;
const SYSTICK: usize = 15;
const EXCEPTIONS: usize = FIRST_INTERRUPT + 82;

/// Offsets from 0xE000_E000.
const SYST_CSR: u32 = 0x10;
const SYST_RVR: u32 = 0x14;
const ISER: u32 = 0x100;
const ICER: u32 = 0x180;
const ISPR: u32 = 0x200;
const ICPR: u32 = 0x280;
const IPR: u32 = 0x400;
const VTOR: u32 = 0xd08;
const AIRCR: u32 = 0xd0c;
const SHPR1: u32 = 0xd18;

/// Key and SYSRESETREQ of AIRCR (PM0214, 4.4.5).
const RESET_REQUEST: u32 = 0x05fa_0000 | 1 << 2;

/// One exception.
#[derive(Debug, Clone, Copy, Default)]
struct Exception {
    enabled: bool,
    pending: bool,
    active: bool,
    priority: u8,
    /// Level of the line that asks, as last seen.
    asks: bool,
}

/// The registers and the state of all exceptions.
pub struct Core {
    registers: Registers,
    exceptions: [Exception; EXCEPTIONS],
    /// Those under way, innermost last.
    nested: Vec<usize>,
    /// When SysTick turns over.
    tick_ps: Option<u64>,
    /// SYSRESETREQ was written.
    pub(crate) reset_requested: bool,
    /// How often each was entered.
    pub entered: [u64; EXCEPTIONS],
}

impl Core {
    pub(super) fn new() -> Self {
        let mut exceptions = [Exception::default(); EXCEPTIONS];
        for system in &mut exceptions[..FIRST_INTERRUPT] {
            system.enabled = true;
        }
        let mut registers = Registers::default();
        registers.set(VTOR, crate::image::FLASH);
        Self {
            registers,
            exceptions,
            nested: Vec::new(),
            tick_ps: None,
            reset_requested: false,
            entered: [0; EXCEPTIONS],
        }
    }

    /// Level of the line of an interrupt. It pends by rising, and by being high when its handler is
    /// not running (ARMv7-M, B3.4.1).
    pub(super) fn line(&mut self, interrupt: usize, asks: bool) {
        let exception = &mut self.exceptions[FIRST_INTERRUPT + interrupt];
        exception.pending |= asks && !(exception.asks && exception.active);
        exception.asks = asks;
    }

    /// What would be taken now, by priority and then by number: it must be more urgent than what is
    /// under way and than `base` (BASEPRI; 0 for none).
    #[must_use]
    pub fn due(&self, base: u8) -> Option<usize> {
        let running = self.nested.last().map(|&n| self.priority(n));
        let limit = [running, (base > 0).then_some(i16::from(base))];
        let limit = limit.into_iter().flatten().min().unwrap_or(i16::MAX);
        let waiting = (0..EXCEPTIONS).filter(|&n| self.waits(n));
        let urgent = waiting.min_by_key(|&n| self.priority(n));
        urgent.filter(|&n| self.priority(n) < limit)
    }

    fn waits(&self, number: usize) -> bool {
        self.exceptions[number].pending && self.exceptions[number].enabled
    }

    fn priority(&self, number: usize) -> i16 {
        if number == HARD_FAULT {
            -1
        } else {
            i16::from(self.exceptions[number].priority)
        }
    }

    /// Whether something would end a sleep: masks do not count (PM0214, 2.5.2).
    #[must_use]
    pub fn wakes(&self) -> bool {
        self.due(0).is_some()
    }

    /// Whether no handler runs.
    #[must_use]
    pub fn in_thread(&self) -> bool {
        self.nested.is_empty()
    }

    /// Number of the exception under way; 0 for none.
    #[must_use]
    pub fn running(&self) -> usize {
        self.nested.last().copied().unwrap_or(0)
    }

    /// A handler begins; its address is in the table of vectors at the address returned.
    pub(crate) fn enter(&mut self, number: usize) -> u32 {
        self.exceptions[number].pending = false;
        self.exceptions[number].active = true;
        self.entered[number] += 1;
        self.nested.push(number);
        self.registers.get(VTOR) + 4 * number as u32
    }

    /// The innermost handler ends.
    pub(crate) fn leave(&mut self) {
        if let Some(number) = self.nested.pop() {
            let exception = &mut self.exceptions[number];
            exception.active = false;
            exception.pending |= exception.asks;
        }
    }

    /// When SysTick turns over.
    pub(super) fn next_ps(&self) -> Option<u64> {
        self.tick_ps
    }

    pub(super) fn catch_up(&mut self, now_ps: u64, hclk: u64) {
        while let Some(tick_ps) = self.tick_ps
            && tick_ps <= now_ps
        {
            self.exceptions[SYSTICK].pending = self.registers.get(SYST_CSR) & 0b10 != 0;
            self.tick_ps = Some(tick_ps + self.period_ps(hclk));
        }
    }

    /// On the core's clock, as CSR asks for here (PM0214, 4.5.1).
    fn period_ps(&self, hclk: u64) -> u64 {
        let cycles = u64::from(self.registers.get(SYST_RVR)) + 1;
        cycles * 1_000_000_000_000 / hclk.max(1)
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        let bits = |is: fn(&Exception) -> bool, from: u32| {
            let first = FIRST_INTERRUPT + 8 * (offset - from) as usize;
            let all = self.exceptions.iter().skip(first).take(32).enumerate();
            all.map(|(bit, e)| u32::from(is(e)) << bit).sum()
        };
        match offset {
            ISER..0x180 => bits(|e| e.enabled, ISER),
            ICER..0x200 => bits(|e| e.enabled, ICER),
            ISPR..0x280 => bits(|e| e.pending, ISPR),
            ICPR..0x300 => bits(|e| e.pending, ICPR),
            _ => self.registers.get(offset),
        }
    }

    pub(super) fn write(&mut self, offset: u32, size: u32, value: u32, now_ps: u64, hclk: u64) {
        match offset {
            SYST_CSR => {
                let starts = value & 1 != 0;
                self.tick_ps = starts.then(|| now_ps + self.period_ps(hclk));
                self.registers.set(offset, value);
            }
            ISER..0x180 => self.each(offset - ISER, value, |e| e.enabled = true),
            ICER..0x200 => self.each(offset - ICER, value, |e| e.enabled = false),
            ISPR..0x280 => self.each(offset - ISPR, value, |e| e.pending = true),
            ICPR..0x300 => self.each(offset - ICPR, value, |e| e.pending = false),
            IPR..0x500 => self.set_priorities(FIRST_INTERRUPT as u32 + offset - IPR, size, value),
            // MemManage is the fourth.
            SHPR1..0xd24 => self.set_priorities(4 + offset - SHPR1, size, value),
            AIRCR => self.reset_requested |= value & RESET_REQUEST == RESET_REQUEST,
            _ => self.registers.set(offset, value),
        }
    }

    /// The interrupts whose bits are set in the word at `offset` of a row of them.
    fn each(&mut self, offset: u32, value: u32, change: fn(&mut Exception)) {
        let first = FIRST_INTERRUPT + 8 * offset as usize;
        let all = self.exceptions.iter_mut().skip(first).enumerate().take(32);
        all.filter(|(bit, _)| value >> bit & 1 != 0)
            .for_each(|(_, exception)| change(exception));
    }

    /// A byte each; this part has the upper four bits (PM0214, 4.3.7).
    fn set_priorities(&mut self, first: u32, size: u32, value: u32) {
        let bytes = value.to_le_bytes();
        let all = self.exceptions.iter_mut().skip(first as usize);
        for (exception, byte) in all.zip(&bytes[..size.min(4) as usize]) {
            exception.priority = byte & 0xf0;
        }
    }
}
