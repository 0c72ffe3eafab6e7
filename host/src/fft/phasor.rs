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
        let cycles = -0.013_37;
        let (first, mut index) = (10_000_019, 10_000_019);
        let values = vec![(); 3 * BLOCK + 7];
        Phasor::new(cycles).zip(first, values, Complex64::new(2.0, 0.0), |(), phasor| {
            let angle = TAU * (f64::from(index) * cycles).fract();
            let error = phasor - 2.0 * Complex64::cis(angle);
            // Ten million times a frequency is known to half a unit of 1e5 cycles in the last place.
            assert!(error.norm() < 1e-10, "{index}: {error}");
            index += 1;
        });
        assert_eq!(index as usize, first as usize + 3 * BLOCK + 7);
    }
}
