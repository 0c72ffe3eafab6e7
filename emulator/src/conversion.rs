//! One converter's analog side and arithmetic: from a signal to words, without bus or time.
//!
//! Whoever wants the words that a converter must have sent makes them again with this, from the
//! same signal and the same registers.

use crate::{
    Output, Registers, Signal,
    filter::{DECIMATION, Filter},
    high_pass::HighPass,
    modulator::{Block, Modulator},
    time::SETTLING_CONVERSIONS,
    word::{calibrated, fir_word, sinc_word},
};

/// A signal on its way to words.
///
/// ```
/// use inm_emulator::{Constant, Conversion, Registers};
/// let mut conversion = Conversion::new(Constant(-3));
/// assert_eq!(conversion.next_word(&Registers::default()), 0xFFFF_FFFB);
/// ```
#[derive(Debug, Clone)]
pub struct Conversion<S> {
    signal: S,
    rate_hz: u32,
    modulator: Modulator,
    filter: Filter,
    high_pass: HighPass,
    /// The filter is empty: the inputs of the lost readings come first.
    restarted: bool,
    /// Input while overloaded, and for how many more conversions.
    overload: Option<(i32, u32)>,
}

impl<S: Signal> Conversion<S> {
    /// A converter at the end of `signal`, its filter empty.
    pub fn new(signal: S) -> Self {
        Self {
            signal,
            rate_hz: 0,
            modulator: Modulator::default(),
            filter: Filter::new(),
            high_pass: HighPass::default(),
            restarted: true,
            overload: None,
        }
    }

    /// Empties the filter, as SYNC, RESET and register writes do.
    ///
    /// The signal goes on where it was when the next word is made: a restart, and a reading that
    /// it cut short, takes no inputs from it. So the words depend on the words before, not on how
    /// long a driver took between two commands.
    pub fn restart(&mut self) {
        self.modulator = Modulator::default();
        self.filter = Filter::new();
        self.high_pass = HighPass::default();
        self.restarted = true;
    }

    /// The next settled word.
    pub fn next_word(&mut self, registers: &Registers) -> u32 {
        let code = self.next_code(registers);
        let calibrated = calibrated(code, registers);
        match registers.output() {
            Output::Sinc => sinc_word(calibrated),
            _ => fir_word(calibrated),
        }
    }

    /// The next settled code ahead of calibration, full scale +-2^30.
    pub fn next_code(&mut self, registers: &Registers) -> i32 {
        let rate_hz = registers.data_rate_hz();
        if rate_hz != self.rate_hz {
            self.rate_hz = rate_hz;
            self.signal.set_rate(DECIMATION as u32 * rate_hz);
        }
        let restarted = core::mem::take(&mut self.restarted);
        if registers.output() == Output::Sinc {
            return self.sinc_code(registers, restarted);
        }
        let lost = if restarted {
            SETTLING_CONVERSIONS - 1
        } else {
            0
        };
        for _ in 0..lost {
            self.fir_code(registers);
        }
        let code = self.fir_code(registers);
        if registers.output() == Output::FirHighPass {
            self.high_pass.next(code, registers.hpf())
        } else {
            code
        }
    }

    fn fir_code(&mut self, registers: &Registers) -> i32 {
        let mut inputs: Block = [0; DECIMATION];
        self.signal.fill(&mut inputs);
        self.drive(&mut inputs, registers);
        self.filter.convert(&inputs, registers.phase())
    }

    fn sinc_code(&mut self, registers: &Registers, restarted: bool) -> i32 {
        let lost = if restarted { 4 } else { 0 };
        let mut code = 0;
        for _ in 0..=lost {
            let mut input = [self.signal.next()];
            self.drive(&mut input, registers);
            code = self.filter.convert_sinc(input[0]);
        }
        code
    }

    /// Overload and modulator.
    fn drive(&mut self, inputs: &mut [i32], registers: &Registers) {
        if let Some((input, left)) = self.overload {
            inputs.fill(input);
            self.overload = (left > 1).then_some((input, left - 1));
        }
        self.modulator.pass(inputs, registers.sinc_decimation());
    }

    /// Drives the input to a value for a number of conversions.
    pub(crate) fn overload(&mut self, input: i32, conversions: u32) {
        self.overload = (conversions > 0).then_some((input, conversions));
    }
}
