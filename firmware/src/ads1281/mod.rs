//! Driver of the ADS1281, a 31-bit delta-sigma converter (Texas Instruments, SBAS378D).
//!
//! ```text
//!   command   opcodes          register  addresses and fields      config  settings to registers
//!   word      one reading: value, over-range, torn                 slip    the level jumped by two
//! ```
//!
//! The part has no CS: every clock counts, nothing realigns a shifted stream but a reset or 64
//! data periods without a clock, and a command in the wrong mode is lost without a word. The
//! driver therefore owns its bus, knows the mode, keeps the gap of 24 clocks after every byte
//! of a command, leaves read-continuous mode before it touches a register, and reads back what
//! it wrote.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::InputPin;
use embedded_hal::spi::SpiBus;

/// Clock of the converter, hertz: the highest it allows, on which its data rates are stated.
pub const CLOCK_HZ: u32 = 4_096_000;

/// DRDY, active low: the level, and a falling edge remembered.
pub trait DataReady: InputPin {
    /// Whether the pin has fallen since the last call.
    ///
    /// The edge is latched by hardware (as in the pending register of an EXTI) or by an
    /// interrupt handler, so that an edge is seen whatever the program did meanwhile, and two
    /// count as one.
    fn take_edge(&mut self) -> bool;
}

/// One converter on its own bus.
#[derive(Debug)]
pub struct Ads1281<SPI, DRDY, DELAY> {
    spi: SPI,
    drdy: DRDY,
    delay: DELAY,
}

impl<SPI, DRDY, DELAY> Ads1281<SPI, DRDY, DELAY>
where
    SPI: SpiBus<u8>,
    DRDY: DataReady,
    DELAY: DelayNs,
{
    /// Takes the bus and the pin. Nothing is sent and so nothing can fail; the first thing to
    /// do is a reset.
    pub fn new(spi: SPI, drdy: DRDY, delay: DELAY) -> Self {
        Self { spi, drdy, delay }
    }

    /// Gives bus, pin and delay back.
    pub fn release(self) -> (SPI, DRDY, DELAY) {
        (self.spi, self.drdy, self.delay)
    }
}
