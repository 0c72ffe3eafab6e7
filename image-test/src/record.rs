//! What the accelerometers put out, and the words that the converters must make of it.

use inm_emulator::channel::{Channel, published};
use inm_emulator::filter::DECIMATION;
use inm_emulator::{Conversion, Registers, Signal};

/// Seed of the accelerometers' noise.
const SEED: u64 = 0x494e_4d41;

/// A published accelerometer that begins anew whenever the data rate changes: what a stream holds
/// then depends on the seed and its rate alone, not on how long the board waited before it.
pub struct Record {
    axis: usize,
    channel: Channel,
}

impl Record {
    /// The signal of an axis, 0 to 2.
    #[must_use]
    pub fn new(axis: usize) -> Self {
        Self {
            axis,
            channel: published(axis, SEED),
        }
    }
}

impl Signal for Record {
    fn set_rate(&mut self, input_hz: u32) {
        *self = Self::new(self.axis);
        self.channel.set_rate(input_hz);
    }

    fn next(&mut self) -> i32 {
        self.channel.next()
    }

    fn fill(&mut self, inputs: &mut [i32; DECIMATION]) {
        self.channel.fill(inputs);
    }
}

/// The words of a stream, made a second time from the seed.
pub struct Expected {
    registers: Registers,
    axes: [Conversion<Channel>; 3],
}

impl Expected {
    /// `config0` is register 01h as the image must have written it (SBAS378D, table 14).
    #[must_use]
    pub fn new(config0: u8) -> Self {
        let mut registers = Registers::default();
        registers.set(0x01, config0);
        Self {
            registers,
            axes: [0, 1, 2].map(|axis| Conversion::new(published(axis, SEED))),
        }
    }

    /// The words of the next conversion, X Y Z.
    pub fn next_words(&mut self) -> [i32; 3] {
        let registers = &self.registers;
        self.axes
            .each_mut()
            .map(|axis| axis.next_word(registers) as i32)
    }
}
