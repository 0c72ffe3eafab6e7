//! Clocks: 168 MHz from the crystal, or from the internal oscillator if it does not start.

use stm32f4xx_hal::pac::RCC;
use stm32f4xx_hal::prelude::_fugit_RateExtU32 as _;
use stm32f4xx_hal::rcc::{Config, Rcc, RccExt};

/// The crystal, hertz.
const CRYSTAL_HZ: u32 = 8_000_000;

/// Looks at the crystal's ready flag before it is given up: about 10 cycles each at 16 MHz
/// make 0.1 s; it starts within 2 ms (STM32F405 data sheet, HSE oscillator characteristics).
const PATIENCE: u32 = 160_000;

/// Starts the clocks; `true` where the crystal did not start and the internal oscillator, good
/// to 1 %, has to do. The link's speed bears that.
pub fn start(rcc: RCC) -> (Rcc, bool) {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    // The HAL would wait for ever.
    let started = (0..PATIENCE).any(|_| rcc.cr().read().hserdy().bit_is_set());
    let source = if started {
        Config::hse(CRYSTAL_HZ.Hz())
    } else {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
        Config::hsi()
    };
    // APB1 at 42 MHz and APB2 at 84 MHz divide to the same SCLK; their timers run at 84 MHz.
    let config = source
        .sysclk(168.MHz())
        .hclk(168.MHz())
        .pclk1(42.MHz())
        .pclk2(84.MHz());
    (rcc.freeze(config), !started)
}
