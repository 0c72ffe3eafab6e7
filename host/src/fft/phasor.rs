//! Cosine and sine of one frequency at every sample, for the price of a multiplication each.

use std::f64::consts::TAU;

use realfft::num_complex::Complex64;

/// Samples between two evaluations of sine and cosine themselves.
const BLOCK: usize = 64;

/// `e^{2 pi i f n}` for a frequency `f`, cycles a sample, which may be negative.
pub struct Phasor {
    cycles: f64,
    /// Those of the first samples.
    steps: [Complex64; BLOCK],
}

impl Phasor {
    /// Of the frequency `cycles` a sample.
    pub fn new(cycles: f64) -> Self {
        let step = |n: usize| Complex64::cis(TAU * (n as f64 * cycles).fract());
        Self {
            cycles,
            steps: std::array::from_fn(step),
        }
    }

    /// At the sample `index`.
    fn at(&self, index: usize) -> Complex64 {
        // The fraction of a cycle, so that long records lose no digits.
        Complex64::cis(TAU * (index as f64 * self.cycles).fract())
    }

    /// Shows `visit` each of `values`, the first of which is the sample `first`, with the phasor there
    /// times `amplitude`.
    pub fn zip<T>(
        &self,
        first: usize,
        values: impl IntoIterator<Item = T>,
        amplitude: Complex64,
        mut visit: impl FnMut(T, Complex64),
    ) {
        let (mut next, mut block) = (first, [Complex64::ZERO; BLOCK]);
        let mut values = values.into_iter();
        loop {
            let turn = amplitude * self.at(next);
            for (one, step) in block.iter_mut().zip(&self.steps) {
                *one = turn * step;
            }
            let mut seen = 0;
            for (value, phasor) in values.by_ref().take(BLOCK).zip(&block) {
                visit(value, *phasor);
                seen += 1;
            }
            if seen < BLOCK {
                return;
            }
            next += BLOCK;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phasor_is_a_cosine_and_a_sine() {
        const FIRST: u32 = 10_000_019;
        const COUNT: u32 = 3 * BLOCK as u32 + 7;
        let cycles = -0.013_37;
        let indices = FIRST..FIRST + COUNT;
        let mut seen = Vec::new();
        Phasor::new(cycles).zip(
            FIRST as usize,
            indices.clone(),
            2.0.into(),
            |index, phasor| {
                let turns = (f64::from(index) * cycles).fract();
                let error = phasor - 2.0 * Complex64::cis(TAU * turns);
                // Both round a product of some 2^17 cycles, by 2^-36 at most.
                let bound = 2.0 * 2.0 * TAU * 2_f64.powi(-36);
                assert!(error.norm() < bound, "{index}: {error}");
                seen.push(index);
            },
        );
        assert!(seen.into_iter().eq(indices));
    }
}
