//! The digital filter: sinc5, then FIR1 to FIR4, 32 inputs to one word (SBAS378D page 15).
//!
//! The input comes at 32 times the data rate, where the part's sinc stage hands over to the FIR
//! stages. The sinc5 of an input that is given at just this rate, as impulses, is the quintic
//! average sampled there: the B-spline of order five, 1, 76, 230, 76, 1 over 384. It is the limit
//! of the sinc5 of decimation N for large N. At N = 8, the smallest, the two differ by 3e-4 dB at
//! the data rate's Nyquist frequency, a tenth of the pass-band ripple, and by a quarter of it for
//! each rate below.

use crate::{
    Phase,
    fir::{Line, general, half_band, round, symmetric},
    tables::{
        FIR1, FIR1_SHIFT, FIR1_TAPS, FIR2, FIR2_SHIFT, FIR2_TAPS, FIR3_LINEAR, FIR3_MINIMUM,
        FIR3_SHIFT, FIR3_TAPS, FIR4_LINEAR, FIR4_MINIMUM, FIR4_SHIFT, FIR4_TAPS,
    },
};

/// Inputs to one word.
pub const DECIMATION: usize = 32;

/// The sinc5's five weights, sum 2^[`SINC5_SHIFT`]: 384ths cannot be had by shifting, and these
/// are within 3e-9 of them.
pub const SINC5: [i32; 5] = [2_796_203, 212_511_403, 643_126_612, 212_511_403, 2_796_203];
/// The sinc5's unit gain as a power of two.
pub const SINC5_SHIFT: u32 = 30;

/// The filter and what it remembers. Words are in steps of the 31-bit code, full scale +-2^30.
#[derive(Debug, Clone)]
pub struct Filter {
    sinc5: Line<{ 4 + DECIMATION }>,
    fir1: Line<{ FIR1_TAPS - 1 + DECIMATION }>,
    fir2: Line<{ FIR2_TAPS - 1 + DECIMATION / 2 }>,
    fir3: Line<{ FIR3_TAPS - 1 + DECIMATION / 4 }>,
    fir4: Line<{ FIR4_TAPS - 1 + DECIMATION / 16 }>,
}

impl Filter {
    /// The filter at rest.
    pub const fn new() -> Self {
        Self {
            sinc5: Line::new(),
            fir1: Line::new(),
            fir2: Line::new(),
            fir3: Line::new(),
            fir4: Line::new(),
        }
    }

    /// Filters the inputs of one conversion and returns its word.
    pub fn convert(&mut self, inputs: &[i32; DECIMATION], phase: Phase) -> i32 {
        *self.sinc5.advance() = *inputs;
        for (i, out) in self.fir1.advance::<DECIMATION>().iter_mut().enumerate() {
            *out = sinc5(self.sinc5.window(i, 1));
        }
        for (i, out) in self
            .fir2
            .advance::<{ DECIMATION / 2 }>()
            .iter_mut()
            .enumerate()
        {
            *out = round(half_band(self.fir1.window(i, 2), &FIR1), FIR1_SHIFT);
        }
        for (i, out) in self
            .fir3
            .advance::<{ DECIMATION / 4 }>()
            .iter_mut()
            .enumerate()
        {
            *out = round(half_band(self.fir2.window(i, 2), &FIR2), FIR2_SHIFT);
        }
        for (i, out) in self
            .fir4
            .advance::<{ DECIMATION / 16 }>()
            .iter_mut()
            .enumerate()
        {
            let window = self.fir3.window(i, 4);
            let sum = match phase {
                Phase::Linear => symmetric(window, &FIR3_LINEAR),
                Phase::Minimum => general(window, &FIR3_MINIMUM),
            };
            *out = round(sum, FIR3_SHIFT);
        }
        let window = self.fir4.window(0, 2);
        let sum = match phase {
            Phase::Linear => symmetric(window, &FIR4_LINEAR),
            Phase::Minimum => general(window, &FIR4_MINIMUM),
        };
        round(sum, FIR4_SHIFT)
    }

    /// Passes one input through the sinc stage alone and returns its word (FILTR = 01).
    pub fn convert_sinc(&mut self, input: i32) -> i32 {
        *self.sinc5.advance() = [input];
        let newest = self.sinc5.window::<5>(DECIMATION - 1, 1);
        sinc5(newest)
    }
}

impl Default for Filter {
    fn default() -> Self {
        Self::new()
    }
}

/// No saturation here: the weights are positive and their sum is one.
fn sinc5(window: &[i32; 5]) -> i32 {
    ((symmetric(window, &SINC5) + (1 << (SINC5_SHIFT - 1))) >> SINC5_SHIFT) as i32
}
