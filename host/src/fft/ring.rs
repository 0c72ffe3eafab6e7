//! Transforms of whole records in their own memory.
//!
//! A planner's transform of ten million samples brings tables as long as the record and a second copy
//! of it. Here a length `M = R s R` is split as D. H. Bailey (J. Supercomputing 4 (1990) 23) does:
//! transforms of length `R` down the columns of `R` rows, a turn of each number, transforms of length
//! `s R` along the rows. The result stands in the order of its digits read backwards; as the first
//! and the last digit have one radix, that is put right by exchanging pairs. Tables and scratch are of
//! the order of a row.
//!
//! `N = 2 M` real samples are transformed as `M` complex pairs (J. W. Cooley, P. A. W. Lewis and P. D.
//! Welch, J. Sound Vib. 12 (1970) 315).

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use num_complex::Complex64;
use rustfft::Fft;

use super::turns::Turns;

/// Columns that are transformed together: two lines of the cache wide.
const TOGETHER: usize = 8;

/// Side of the squares that are exchanged at a time.
const TILE: usize = 16;

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
    /// `R`.
    outer: usize,
    /// `s`.
    inner: usize,
    forward: Plans,
    inverse: Plans,
    turns: Turns,
}

struct Plans {
    column: Arc<dyn Fft<f64>>,
    row: Arc<dyn Fft<f64>>,
}

impl Ring {
    /// For `len` real samples, an even number. Fast where it has no prime factor above 5.
    pub fn new(len: usize) -> Self {
        let (outer, inner) = split(len / 2);
        Self {
            outer,
            inner,
            forward: Plans {
                column: super::forward(outer),
                row: super::forward(inner * outer),
            },
            inverse: Plans {
                column: super::inverse(outer),
                row: super::inverse(inner * outer),
            },
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
        self.transform(&mut ordinates[..pairs], &self.forward, |turn| turn);
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
        self.transform(&mut ordinates[..pairs], &self.inverse, |turn| turn.conj());
        Series { pairs: ordinates }
    }

    /// Transform of complex numbers in their place; `turn` tells the direction.
    fn transform(
        &self,
        data: &mut [Complex64],
        plans: &Plans,
        turn: impl Fn(Complex64) -> Complex64,
    ) {
        let (outer, width) = (self.outer, self.inner * self.outer);
        let mut some = vec![Complex64::ZERO; TOGETHER * outer];
        let scratch = plans.column.get_inplace_scratch_len();
        let scratch = scratch.max(plans.row.get_inplace_scratch_len());
        let mut scratch = vec![Complex64::ZERO; scratch];
        for first in (0..width).step_by(TOGETHER) {
            let count = TOGETHER.min(width - first);
            let some = &mut some[..count * outer];
            for (row, data) in data.chunks_exact(width).enumerate() {
                for (column, value) in data[first..first + count].iter().enumerate() {
                    some[column * outer + row] = *value;
                }
            }
            plans.column.process_with_scratch(some, &mut scratch);
            for (column, some) in some.chunks_exact_mut(outer).enumerate() {
                for (k, value) in some.iter_mut().enumerate() {
                    *value *= turn(self.turns.at(2 * k * (first + column)));
                }
            }
            for (row, data) in data.chunks_exact_mut(width).enumerate() {
                for (column, value) in data[first..first + count].iter_mut().enumerate() {
                    *value = some[column * outer + row];
                }
            }
        }
        let mut turned = vec![Complex64::ZERO; width];
        for row in data.chunks_exact_mut(width) {
            plans.row.process_with_scratch(row, &mut scratch);
            // The two digits of a row backwards.
            turned.copy_from_slice(row);
            for (place, row) in row.chunks_exact_mut(outer).enumerate() {
                let digits = turned.iter().skip(place).step_by(self.inner);
                row.iter_mut().zip(digits).for_each(|(to, from)| *to = *from);
            }
        }
        for middle in 0..self.inner {
            exchange(data, outer, middle * outer, width);
        }
    }
}

/// Exchanges rows and columns of the square of `side` numbers that begins at `first`, its rows
/// `width` apart.
fn exchange(data: &mut [Complex64], side: usize, first: usize, width: usize) {
    for top in (0..side).step_by(TILE) {
        for left in (top..side).step_by(TILE) {
            for row in top..(top + TILE).min(side) {
                for column in left.max(row + 1)..(left + TILE).min(side) {
                    let here = first + row * width + column;
                    let there = first + column * width + row;
                    data.swap(here, there);
                }
            }
        }
    }
}

/// `R` and `s` of a length `R s R`, `s` as small as the prime factors 2, 3 and 5 let it be.
fn split(len: usize) -> (usize, usize) {
    let (mut outer, mut inner) = (1, len);
    for prime in [2, 3, 5] {
        while inner.is_multiple_of(prime * prime) {
            inner /= prime * prime;
            outer *= prime;
        }
    }
    (outer, inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Seed;
    use crate::simulate::Gaussian;

    /// Every kind of split: powers of one prime, each `s`, and a length that is not smooth.
    const LENGTHS: [usize; 10] = [2, 4, 6, 32, 90, 1 << 12, 2 * 3 * 3 * 5 * 5, 7200, 30_720, 202];

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
        // A slow cycle 200 dB above the noise, about as a walk of hours beside quantisation.
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
        // Half a unit in the last place of 1e6 is 6e-11, beside noise of 1e-4: -124 dB.
        assert!(error < 1e-11 * power, "{:e}, seed 1", error / power);
    }
}
