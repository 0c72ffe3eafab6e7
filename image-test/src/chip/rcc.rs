//! RCC: oscillators, PLL, bus clocks, reset flags (RM0090, section 7).

use super::Registers;

const CR: u32 = 0x00;
const PLLCFGR: u32 = 0x04;
const CFGR: u32 = 0x08;
const CSR: u32 = 0x74;

/// Bits of CR (7.3.1).
const HSI_ON_READY: u32 = 0b11;
const HSE_ON: u32 = 1 << 16;
const HSE_READY: u32 = 1 << 17;
const PLL_ON: u32 = 1 << 24;
const PLL_READY: u32 = 1 << 25;

/// RMVF of CSR removes the reset flags (7.3.21).
const REMOVE_FLAGS: u32 = 1 << 24;

/// The internal oscillator, hertz (7.2.2).
const HSI_HZ: u64 = 16_000_000;

/// The crystal of this board, hertz.
const HSE_HZ: u64 = 8_000_000;

/// Start of a crystal: 2 ms typically (STM32F405 data sheet, HSE oscillator characteristics).
const HSE_START_PS: u64 = 2_000_000_000;

/// Why the chip was reset, as the flags of CSR tell it (7.3.21); the reset pin is pulled along each time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Power came on.
    Power,
    /// SYSRESETREQ.
    Software,
    /// The independent watchdog.
    Watchdog,
}

impl Cause {
    fn flags(self) -> u32 {
        const PIN: u32 = 1 << 26;
        match self {
            Self::Power => PIN | 1 << 25 | 1 << 27,
            Self::Software => PIN | 1 << 28,
            Self::Watchdog => PIN | 1 << 29,
        }
    }
}

/// Clocks that follow from the registers, hertz; all zero when their source has stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Clocks {
    /// Core, SysTick, GPIO.
    pub hclk: u64,
    /// SPI2, SPI3.
    pub pclk1: u64,
    /// SPI1, USART1, ADC1.
    pub pclk2: u64,
    /// TIM2: twice PCLK1 where that is divided (7.2, figure 21).
    pub timclk1: u64,
}

/// The peripheral.
pub struct Rcc {
    registers: Registers,
    crystal: bool,
    hse_on_ps: Option<u64>,
    /// What runs at which speed.
    pub clocks: Clocks,
}

impl Rcc {
    /// After a reset; `flags` are those left by earlier ones.
    pub(super) fn new(crystal: bool, flags: u32, cause: Cause) -> Self {
        let mut registers = Registers::default();
        registers.set(CSR, flags | cause.flags());
        // 7.3.2: M 16, N 192, P 2.
        registers.set(PLLCFGR, 0x2400_3010);
        let mut rcc = Self {
            registers,
            crystal,
            hse_on_ps: None,
            clocks: Clocks::default(),
        };
        rcc.clocks = rcc.tree();
        rcc
    }

    /// The flags of CSR.
    #[must_use]
    pub fn flags(&self) -> u32 {
        self.registers.get(CSR)
    }

    /// Lets the crystal swing, or stops it.
    pub(super) fn set_crystal(&mut self, swings: bool) {
        self.crystal = swings;
        self.clocks = self.tree();
    }

    pub(super) fn read(&self, offset: u32, now_ps: u64) -> u32 {
        let value = self.registers.get(offset);
        match offset {
            CR => {
                let hse = self
                    .hse_on_ps
                    .is_some_and(|on| self.crystal && now_ps >= on + HSE_START_PS);
                let hse = if hse { HSE_READY } else { 0 };
                let pll = if value & PLL_ON != 0 { PLL_READY } else { 0 };
                value & !(HSE_READY | PLL_READY) | HSI_ON_READY | hse | pll
            }
            // SWS says what SW asked for.
            CFGR => value & !0b1100 | (value & 0b11) << 2,
            _ => value,
        }
    }

    pub(super) fn write(&mut self, offset: u32, value: u32, now_ps: u64) {
        match offset {
            CSR if value & REMOVE_FLAGS != 0 => self.registers.set(CSR, value & 1),
            CSR => {}
            _ => self.registers.set(offset, value),
        }
        if offset == CR {
            let on = value & HSE_ON != 0;
            self.hse_on_ps = on.then(|| self.hse_on_ps.unwrap_or(now_ps));
        }
        self.clocks = self.tree();
    }

    /// Whether the clock of a peripheral is on: a bit of one of the enable registers.
    pub(super) fn enabled(&self, (offset, bit): (u32, u32)) -> bool {
        self.registers.get(offset) >> bit & 1 != 0
    }

    /// 7.2, figure 21.
    fn tree(&self) -> Clocks {
        let hse_hz = if self.crystal { HSE_HZ } else { 0 };
        let pll = u64::from(self.registers.get(PLLCFGR));
        let cfgr = self.registers.get(CFGR);
        let system_hz = match cfgr & 0b11 {
            0 => HSI_HZ,
            1 => hse_hz,
            _ => {
                let source_hz = if pll >> 22 & 1 != 0 { hse_hz } else { HSI_HZ };
                let (m, n, p) = (pll & 63, pll >> 6 & 511, 2 * ((pll >> 16 & 3) + 1));
                source_hz * n / m.max(1) / p
            }
        };
        // HPRE divides from 8 on by 2, 4, 8, 16, 64 and so on, PPRE from 4 on by 2, 4, 8, 16 (7.3.3).
        let ahb = match cfgr >> 4 & 15 {
            code @ 8..12 => 1 << (code - 7),
            code @ 12.. => 1 << (code - 6),
            _ => 1,
        };
        let apb = |code: u32| if code < 4 { 1 } else { 1 << (code - 3) };
        let (apb1, apb2): (u64, u64) = (apb(cfgr >> 10 & 7), apb(cfgr >> 13 & 7));
        let hclk = system_hz / ahb;
        Clocks {
            hclk,
            pclk1: hclk / apb1,
            pclk2: hclk / apb2,
            timclk1: if apb1 == 1 { hclk } else { 2 * hclk / apb1 },
        }
    }
}
