//! The digital high-pass filter behind the FIR stages (FILTR = 11; SBAS378D page 17).
//!
//! `H(z) = (2 - a)/2 (1 - z^-1) / (1 - b z^-1)` with a = HPF/65536 and b = (1 + (1 - a)^2)/2. Its
//! gain at the programmed corner comes out as -3.01 dB and its gain error as published, which is
//! what speaks for this form; the sheet's own difference equation was not at hand.

/// Fraction bits of the state: with corners down to 1e-4 of the data rate it must not stick.
const FRACTION: u32 = 24;

/// The filter's state.
#[derive(Debug, Clone, Default)]
pub(crate) struct HighPass {
    previous: i32,
    state: i64,
}

impl HighPass {
    /// Next output; `hpf` is the register word.
    pub(crate) fn next(&mut self, input: i32, hpf: u16) -> i32 {
        let a = i64::from(hpf);
        let step = i64::from(input) - i64::from(self.previous);
        self.previous = input;
        // 1 - b = a (2 - a) / 2, here in 2^-33; (2 - a) / 2 in 2^-17.
        let leak = (i128::from(self.state) * i128::from(a * (131_072 - a))) >> 33;
        let gain = (131_072 - a) << (FRACTION - 17);
        self.state = self.state - leak as i64 + step * gain;
        let rounded = (self.state + (1 << (FRACTION - 1))) >> FRACTION;
        rounded.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_decays_with_the_programmed_time_constant() {
        // HPF = 0332h: b = 1 - a + a^2/2; after n conversions (2-a)/2 b^n of the step is left.
        let hpf = 0x0332;
        let a = f64::from(hpf) / 65536.0;
        let b = (1.0 + (1.0 - a) * (1.0 - a)) / 2.0;
        let mut filter = HighPass::default();
        let mut expected = (2.0 - a) / 2.0 * 1e9;
        for n in 0..2000 {
            let word = filter.next(1_000_000_000, hpf);
            assert!((f64::from(word) - expected).abs() < 1.0, "conversion {n}");
            expected *= b;
        }
        assert!(
            filter.next(1_000_000_000, hpf).abs() < 20,
            "the constant is gone"
        );
    }
}
