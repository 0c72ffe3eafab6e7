//! Signals at the converter's input, and simple ones for tests.

use crate::filter::DECIMATION;

/// Voltage at the converter's input, sampled at 32 times the data rate.
///
/// The unit is the step of the 31-bit code, VREF / (2 (2^30 - 1)) volts: 2.33 nV at VREF = 5 V.
/// Full scale is +-2^30.
pub trait Signal {
    /// Told ahead of the first input and whenever the inputs a second change.
    fn set_rate(&mut self, input_hz: u32);

    /// The next input.
    fn next(&mut self) -> i32;

    /// The next inputs of one conversion. The same as 32 times [`Signal::next`], perhaps faster.
    fn fill(&mut self, inputs: &mut [i32; DECIMATION]) {
        for input in inputs {
            *input = self.next();
        }
    }
}

impl<S: Signal + ?Sized> Signal for &mut S {
    fn set_rate(&mut self, input_hz: u32) {
        (**self).set_rate(input_hz);
    }

    fn next(&mut self) -> i32 {
        (**self).next()
    }

    fn fill(&mut self, inputs: &mut [i32; DECIMATION]) {
        (**self).fill(inputs);
    }
}

/// The same input for ever.
#[derive(Debug, Clone, Copy)]
pub struct Constant(pub i32);

impl Signal for Constant {
    fn set_rate(&mut self, _input_hz: u32) {}

    fn next(&mut self) -> i32 {
        self.0
    }
}

/// A line from `start` on that changes by `slope_per_s` steps a second and stops at the ends of
/// `i32`.
#[derive(Debug, Clone, Copy)]
pub struct Ramp {
    /// Level, 2^-32 steps.
    level: i64,
    slope_per_s: i32,
    /// Change from input to input, 2^-32 steps.
    slope: i64,
}

impl Ramp {
    /// A ramp from `start`, in steps, by `slope_per_s` steps a second.
    pub const fn new(start: i32, slope_per_s: i32) -> Self {
        Self {
            level: (start as i64) << 32,
            slope_per_s,
            slope: 0,
        }
    }
}

impl Signal for Ramp {
    fn set_rate(&mut self, input_hz: u32) {
        self.slope = (i64::from(self.slope_per_s) << 32) / i64::from(input_hz.max(1));
    }

    fn next(&mut self) -> i32 {
        let input = (self.level >> 32) as i32;
        self.level = self.level.saturating_add(self.slope);
        input
    }
}

/// A sine on an offset, from an integer phase: exact in frequency, within 1e-7 of its amplitude.
#[derive(Debug, Clone, Copy)]
pub struct Sine {
    offset: i32,
    amplitude: i32,
    frequency_mhz: u32,
    /// Phase, 2^-64 turns, and its advance an input.
    phase: u64,
    advance: u64,
}

impl Sine {
    /// A sine of `amplitude` steps at `frequency_mhz` millihertz, rising through `offset` at
    /// first.
    pub const fn new(offset: i32, amplitude: i32, frequency_mhz: u32) -> Self {
        Self {
            offset,
            amplitude,
            frequency_mhz,
            phase: 0,
            advance: 0,
        }
    }
}

impl Signal for Sine {
    fn set_rate(&mut self, input_hz: u32) {
        let turns = u128::from(self.frequency_mhz) << 64;
        self.advance = (turns / (1000 * u128::from(input_hz.max(1)))) as u64;
    }

    fn next(&mut self) -> i32 {
        let sine = sine_q30((self.phase >> 32) as u32);
        self.phase = self.phase.wrapping_add(self.advance);
        let swing = (i64::from(self.amplitude) * i64::from(sine)) >> 30;
        self.offset.saturating_add(swing as i32)
    }
}

/// Sine of a phase in 2^-32 turns, in 2^-30: the series in the quarter turn z = 0..1 up to z^11.
fn sine_q30(phase: u32) -> i32 {
    // Coefficients (pi/2)^(2k+1) / (2k+1)!, signs alternating, in 2^-30.
    const SERIES: [i64; 6] = [
        1_686_629_713,
        -693_598_668,
        85_569_306,
        -5_026_995,
        172_272,
        -3_864,
    ];
    // Folded into -1/4..1/4 turn: the second and third quarters run backwards.
    let turn = phase as i32;
    let folded = if (phase.wrapping_add(1 << 30)) >> 31 == 0 {
        turn
    } else {
        i32::MIN.wrapping_sub(turn)
    };
    let z = i64::from(folded);
    let square = (z * z) >> 30;
    let sum = SERIES
        .iter()
        .rev()
        .fold(0, |sum, &term| term + ((sum * square) >> 30));
    ((sum * z) >> 30) as i32
}

/// Recorded inputs, over and over.
#[derive(Debug, Clone, Copy)]
pub struct Recorded<'a> {
    inputs: &'a [i32],
    next: usize,
}

impl<'a> Recorded<'a> {
    /// Plays `inputs` in a loop; none at all is a constant zero.
    pub const fn new(inputs: &'a [i32]) -> Self {
        Self { inputs, next: 0 }
    }
}

impl Signal for Recorded<'_> {
    fn set_rate(&mut self, _input_hz: u32) {}

    fn next(&mut self) -> i32 {
        let Some(&input) = self.inputs.get(self.next) else {
            return 0;
        };
        self.next = (self.next + 1) % self.inputs.len();
        input
    }
}
