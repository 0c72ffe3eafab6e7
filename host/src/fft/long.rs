//! Long transforms in place, with short tables.
//!
//! A planner's transform of millions of numbers brings tables as long as they are and a second copy of
//! them. Here a length `M = R s R` is split as D. H. Bailey (J. Supercomputing 4 (1990) 23) does:
//! transforms of length `R` down the columns of `R` rows, a turn of each number, transforms of length
//! `s R` along the rows. The result stands in the order of its digits read backwards; as the first
//! and the last digit have one radix, that is put right by exchanging pairs. Tables and scratch are of
//! the order of a row. Columns and rows are shared between two threads; whatever one of them does, the
//! result is the same.

use std::sync::Arc;

use num_complex::Complex64;
use rayon::prelude::*;
use rustfft::Fft;

use super::turns::Turns;

/// Columns that are transformed together: two lines of the cache wide.
const TOGETHER: usize = 8;

/// Side of the squares that are exchanged at a time.
const TILE: usize = 16;

/// Transforms of one length.
pub struct Long {
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

impl Long {
    /// Of `len` numbers, one at least. Fast and small where it has no prime factor above 5.
    pub fn new(len: usize) -> Self {
        let (outer, inner) = split(len);
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

    /// `X_k = sum x_n e^{-2 pi i k n / M}`.
    pub fn forward(&self, data: &mut [Complex64]) {
        self.transform(data, &self.forward, |turn| turn);
    }

    /// Back again, times `M`.
    pub fn inverse(&self, data: &mut [Complex64]) {
        self.transform(data, &self.inverse, |turn| turn.conj());
    }

    /// Either way; `turn` says which.
    fn transform(
        &self,
        data: &mut [Complex64],
        plans: &Plans,
        turn: impl Fn(Complex64) -> Complex64 + Sync,
    ) {
        let (outer, width) = (self.outer, self.inner * self.outer);
        // Whole groups of columns on either side.
        let middle = (width / 2).next_multiple_of(TOGETHER).min(width);
        let rows = data.chunks_exact_mut(width);
        let (left, right): (Vec<_>, Vec<_>) = rows.map(|row| row.split_at_mut(middle)).unzip();
        rayon::join(
            || self.columns(left, 0, &*plans.column, &turn),
            || self.columns(right, middle, &*plans.column, &turn),
        );
        data.par_chunks_exact_mut(width).for_each_init(
            || {
                let scratch = plans.row.get_inplace_scratch_len();
                let new = |len| vec![Complex64::ZERO; len];
                (new(scratch), new(width))
            },
            |(scratch, turned), row| {
                plans.row.process_with_scratch(row, scratch);
                // The two digits of a row backwards.
                turned.copy_from_slice(row);
                for (place, row) in row.chunks_exact_mut(outer).enumerate() {
                    let digits = turned.iter().skip(place).step_by(self.inner);
                    row.iter_mut()
                        .zip(digits)
                        .for_each(|(to, from)| *to = *from);
                }
            },
        );
        for middle in 0..self.inner {
            exchange(data, outer, middle * outer, width);
        }
    }

    /// Transforms the columns that the `rows` hold, of which the first has the number `from`, and turns
    /// each number.
    fn columns(
        &self,
        mut rows: Vec<&mut [Complex64]>,
        from: usize,
        plan: &dyn Fft<f64>,
        turn: impl Fn(Complex64) -> Complex64,
    ) {
        let outer = self.outer;
        let width = rows.first().map_or(0, |row| row.len());
        let mut some = vec![Complex64::ZERO; TOGETHER * outer];
        let mut scratch = vec![Complex64::ZERO; plan.get_inplace_scratch_len()];
        for first in (0..width).step_by(TOGETHER) {
            let count = TOGETHER.min(width - first);
            let some = &mut some[..count * outer];
            for (number, row) in rows.iter().enumerate() {
                for (column, value) in row[first..first + count].iter().enumerate() {
                    some[column * outer + number] = *value;
                }
            }
            plan.process_with_scratch(some, &mut scratch);
            for (column, some) in some.chunks_exact_mut(outer).enumerate() {
                for (k, value) in some.iter_mut().enumerate() {
                    *value *= turn(self.turns.at(k * (from + first + column)));
                }
            }
            for (number, row) in rows.iter_mut().enumerate() {
                for (column, value) in row[first..first + count].iter_mut().enumerate() {
                    *value = some[column * outer + number];
                }
            }
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
