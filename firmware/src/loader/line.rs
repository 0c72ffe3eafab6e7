//! The line, without interrupts: a host says one thing at a time and waits for the answer.

use inm_firmware::platform::BAUD;
use stm32f4xx_hal::gpio::PushPull;
use stm32f4xx_hal::pac::USART1;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{CommonPins, Serial, config};
use stm32f4xx_hal::time::Bps;

/// USART1, set up.
pub struct Line(USART1);

impl Line {
    /// Sets it up, as the program does.
    pub fn start(
        usart: USART1,
        tx: impl Into<<USART1 as CommonPins>::Tx<PushPull>>,
        rx: impl Into<<USART1 as CommonPins>::Rx<PushPull>>,
        rcc: &mut Rcc,
    ) -> Self {
        let config = config::Config::default().baudrate(Bps(BAUD));
        let serial = Serial::<_, u8>::new(usart, (tx, rx), config, rcc);
        // Fails only if the bus clock is below eight times the speed, and it is not.
        let Ok(serial) = serial else {
            panic!("link speed")
        };
        Self(serial.release().0)
    }

    /// The next byte, if one has come. What came while nobody looked is lost, and asked again.
    pub fn receive(&mut self) -> Option<u8> {
        let status = self.0.sr().read();
        let damaged = status.ore().bit() || status.fe().bit() || status.nf().bit();
        if !damaged && status.rxne().bit_is_clear() {
            return None;
        }
        // Reading the data after the status also clears the error flags.
        let byte = self.0.dr().read().dr().bits() as u8;
        (!damaged).then_some(byte)
    }

    /// Sends all of it.
    pub fn send(&mut self, frame: &[u8]) {
        for &byte in frame {
            while self.0.sr().read().txe().bit_is_clear() {}
            self.0.dr().write(|w| w.dr().set(byte.into()));
        }
    }

    /// Waits until the last bit has left.
    pub fn drain(&mut self) {
        while self.0.sr().read().tc().bit_is_clear() {}
    }
}
