//! Transforms of real records in their own memory.
//!
//! `N = 2 M` samples are transformed as `M` complex pairs (J. W. Cooley, P. A. W. Lewis and P. D. Welch,
//! J. Sound Vib. 12 (1970) 315).

use std::ops::{Deref, DerefMut};

use num_complex::Complex64;

use super::long::Long;
use super::turns::Turns;

/// Real samples on a ring, in the memory that their ordinates take.
#[derive(Debug, Clone)]
pub struct Series {
    /// Pairs of neighbours, and one that is spare.
    pairs: Vec<Complex64>,
}

impl Series {
    /// A copy of `values`, an even number of them.
    pub fn new(values: &[f64]) -> Self {
        let mut pairs = vec![Complex64::ZERO; values.len() / 2 + 1];
        bytemuck::cast_slice_mut(&mut pairs)[..values.len()].copy_from_slice(values);
        Self { pairs }
    }
}

impl Deref for Series {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        bytemuck::cast_slice(&self.pairs[..self.pairs.len() - 1])
    }
}

impl DerefMut for Series {
    fn deref_mut(&mut self) -> &mut [f64] {
        let pairs = self.pairs.len() - 1;
        bytemuck::cast_slice_mut(&mut self.pairs[..pairs])
    }
}

/// Transforms of one length.
pub struct Ring {
    pairs: Long,
    turns: Turns,
}

impl Ring {
    /// For `len` real samples, an even number. Fast and small where it has no prime factor above 5.
    pub fn new(len: usize) -> Self {
        Self {
            pairs: Long::new(len / 2),
            turns: Turns::new(len),
        }
    }

    /// `e^{-2 pi i k / N}`.
    pub fn turn(&self, k: usize) -> Complex64 {
        self.turns.at(k)
    }

    /// Ordinates from zero frequency to half the rate, `X_k = sum x_n e^{-2 pi i k n / N}`.
    pub fn forward(&self, series: Series) -> Vec<Complex64> {
        let mut ordinates = series.pairs;
        let pairs = ordinates.len() - 1;
        self.pairs.forward(&mut ordinates[..pairs]);
        let sum = ordinates[0];
        ordinates[0] = Complex64::new(sum.re + sum.im, 0.0);
        ordinates[pairs] = Complex64::new(sum.re - sum.im, 0.0);
        for k in 1..=pairs / 2 {
            let (low, high) = (ordinates[k], ordinates[pairs - k].conj());
            // Transforms of the samples with even numbers, and of the odd ones.
            let even = 0.5 * (low + high);
            let odd = 0.5 * (low - high);
            let odd = Complex64::new(odd.im, -odd.re) * self.turns.at(k);
            ordinates[k] = even + odd;
            ordinates[pairs - k] = (even - odd).conj();
        }
        ordinates
    }

    /// Back to the samples, times their number; the first and the last ordinate are taken for real.
    pub fn inverse(&self, mut ordinates: Vec<Complex64>) -> Series {
        let pairs = ordinates.len() - 1;
        let (first, last) = (ordinates[0].re, ordinates[pairs].re);
        ordinates[0] = Complex64::new(first + last, first - last);
        for k in 1..=pairs / 2 {
            let (low, high) = (ordinates[k], ordinates[pairs - k].conj());
            let even = low + high;
            let odd = (low - high) * self.turns.at(k).conj();
            let odd = Complex64::new(-odd.im, odd.re);
            ordinates[k] = even + odd;
            ordinates[pairs - k] = (even - odd).conj();
        }
        self.pairs.inverse(&mut ordinates[..pairs]);
        Series { pairs: ordinates }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Seed;
    use crate::model::random::Gaussian;

    /// Every kind of split: powers of one prime, each `s`, and a length that is not smooth.
    const LENGTHS: [usize; 10] = [
        2,
        4,
        6,
        32,
        90,
        1 << 12,
        2 * 3 * 3 * 5 * 5,
        7200,
        30_720,
        202,
    ];

    fn series(len: usize) -> Vec<f64> {
        let mut noise = Gaussian::new(Seed { seed: 1, stream: 0 }, 1.0);
        (0..len).map(|_| noise.draw()).collect()
    }

    #[test]
    fn ordinates_are_those_of_a_planner() {
        for len in LENGTHS {
            let values = series(len);
            let ordinates = Ring::new(len).forward(Series::new(&values));
            let plan = super::super::real_forward(len);
            let mut expected = plan.make_output_vec();
            plan.process(&mut values.clone(), &mut expected)
                .expect("the lengths are the plan's own");
            // Rounding grows as the root of the logarithm of the length, in units of the root mean
            // square of the ordinates.
            let bound = 1e-14 * (len as f64).sqrt();
            for (k, (one, other)) in ordinates.iter().zip(&expected).enumerate() {
                assert!((one - other).norm() < bound, "{len}, {k}: {one} {other}");
            }
            assert_eq!(ordinates.len(), expected.len());
        }
    }

    #[test]
    fn there_and_back_is_times_the_length() {
        for len in LENGTHS {
            let values = series(len);
            let ring = Ring::new(len);
            let back = ring.inverse(ring.forward(Series::new(&values)));
            assert_eq!(back.len(), len);
            for (n, (one, other)) in back.iter().zip(&values).enumerate() {
                assert!((one / len as f64 - other).abs() < 2e-14, "{len}, {n}");
            }
        }
    }

    /// A record with walk in it spans more than single precision holds: the quiet end of its
    /// spectrum must not drown in the rounding of the loud one.
    #[test]
    fn rounding_is_far_below_the_quietest_ordinates() {
        // A slow cycle 200 dB above the noise, about as a walk of hours is above quantisation.
        let len = 1 << 16;
        let noise = series(len);
        let loud: Vec<f64> = (0..len)
            .map(|n| {
                let turn = std::f64::consts::TAU * n as f64 / len as f64;
                1e6 * turn.cos() + 1e-4 * noise[n]
            })
            .collect();
        let quiet: Vec<f64> = noise.iter().map(|value| 1e-4 * value).collect();
        let ring = Ring::new(len);
        let (loud, quiet) = (
            ring.forward(Series::new(&loud)),
            ring.forward(Series::new(&quiet)),
        );
        let (mut error, mut power) = (0.0, 0.0);
        for (loud, quiet) in loud.iter().zip(&quiet).skip(2) {
            error += (loud - quiet).norm_sqr();
            power += quiet.norm_sqr();
        }
        // Half a unit in the last place of 1e6 is 6e-11, over noise of 1e-4: -124 dB.
        assert!(error < 1e-11 * power, "{:e}, seed 1", error / power);
    }
}
