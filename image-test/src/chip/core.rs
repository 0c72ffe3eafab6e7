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

/// A bit an exception.
type Set = u128;

const _: () = assert!(EXCEPTIONS <= Set::BITS as usize);

/// The registers and the state of all exceptions.
pub struct Core {
    registers: Registers,
    enabled: Set,
    pending: Set,
    active: Set,
    /// Those whose line asked when it was last looked at.
    asking: Set,
    priorities: [u8; EXCEPTIONS],
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
        let mut registers = Registers::default();
        registers.set(VTOR, crate::image::FLASH);
        Self {
            registers,
            // Those of the system always are.
            enabled: (1 << FIRST_INTERRUPT) - 1,
            pending: 0,
            active: 0,
            asking: 0,
            priorities: [0; EXCEPTIONS],
            nested: Vec::new(),
            tick_ps: None,
            reset_requested: false,
            entered: [0; EXCEPTIONS],
        }
    }

    /// Level of the line of an interrupt. It pends by rising, and by being high when its handler is
    /// not running (ARMv7-M, B3.4.1).
    pub(super) fn line(&mut self, interrupt: usize, asks: bool) {
        let bit = 1 << (FIRST_INTERRUPT + interrupt);
        if !asks {
            self.asking &= !bit;
            return;
        }
        self.pending |= bit & !(self.asking & self.active);
        self.asking |= bit;
    }

    /// What would be taken now, by priority and then by number: it must be more urgent than what is
    /// under way and than `base` (BASEPRI; 0 for none).
    #[must_use]
    pub fn due(&self, base: u8) -> Option<usize> {
        let running = self.nested.last().map(|&n| self.priority(n));
        let limit = [running, (base > 0).then_some(i16::from(base))];
        let limit = limit.into_iter().flatten().min().unwrap_or(i16::MAX);
        let mut waiting = self.pending & self.enabled;
        let each = std::iter::from_fn(|| {
            let number = (waiting != 0).then(|| waiting.trailing_zeros() as usize)?;
            waiting &= waiting - 1;
            Some(number)
        });
        let urgent = each.min_by_key(|&n| self.priority(n));
        urgent.filter(|&n| self.priority(n) < limit)
    }

    fn priority(&self, number: usize) -> i16 {
        if number == HARD_FAULT {
            -1
        } else {
            i16::from(self.priorities[number])
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
        self.pending &= !(1 << number);
        self.active |= 1 << number;
        self.entered[number] += 1;
        self.nested.push(number);
        self.registers.get(VTOR) + 4 * number as u32
    }

    /// The innermost handler ends.
    pub(crate) fn leave(&mut self) {
        if let Some(number) = self.nested.pop() {
            self.active &= !(1 << number);
            self.pending |= self.asking & 1 << number;
        }
    }

    /// Where the table of vectors is.
    #[must_use]
    pub fn vectors(&self) -> u32 {
        self.registers.get(VTOR)
    }

    /// When SysTick turns over.
    pub(super) fn next_ps(&self) -> Option<u64> {
        self.tick_ps
    }

    pub(super) fn catch_up(&mut self, now_ps: u64, hclk: u64) {
        while let Some(tick_ps) = self.tick_ps
            && tick_ps <= now_ps
        {
            if self.registers.get(SYST_CSR) & 0b10 != 0 {
                self.pending |= 1 << SYSTICK;
            }
            self.tick_ps = Some(tick_ps + self.period_ps(hclk));
        }
    }

    /// On the core's clock, as CSR asks for here (PM0214, 4.5.1).
    fn period_ps(&self, hclk: u64) -> u64 {
        let cycles = u64::from(self.registers.get(SYST_RVR)) + 1;
        cycles * 1_000_000_000_000 / hclk.max(1)
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            ISER..0x180 => (self.enabled >> first(offset - ISER)) as u32,
            ICER..0x200 => (self.enabled >> first(offset - ICER)) as u32,
            ISPR..0x280 => (self.pending >> first(offset - ISPR)) as u32,
            ICPR..0x300 => (self.pending >> first(offset - ICPR)) as u32,
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
            ISER..0x180 => self.enabled |= Set::from(value) << first(offset - ISER),
            ICER..0x200 => self.enabled &= !(Set::from(value) << first(offset - ICER)),
            ISPR..0x280 => self.pending |= Set::from(value) << first(offset - ISPR),
            ICPR..0x300 => self.pending &= !(Set::from(value) << first(offset - ICPR)),
            IPR..0x500 => self.set_priorities(FIRST_INTERRUPT as u32 + offset - IPR, size, value),
            // MemManage is the fourth.
            SHPR1..0xd24 => self.set_priorities(4 + offset - SHPR1, size, value),
            AIRCR => self.reset_requested |= value & RESET_REQUEST == RESET_REQUEST,
            _ => self.registers.set(offset, value),
        }
    }

    /// A byte each; this part has the upper four bits (PM0214, 4.3.7).
    fn set_priorities(&mut self, first: u32, size: u32, value: u32) {
        let bytes = value.to_le_bytes();
        let all = self.priorities.iter_mut().skip(first as usize);
        for (priority, byte) in all.zip(&bytes[..size.min(4) as usize]) {
            *priority = byte & 0xf0;
        }
    }
}

/// Exception of the lowest bit of the word at `offset` in a row of them.
fn first(offset: u32) -> u32 {
    FIRST_INTERRUPT as u32 + 8 * offset
}
