//! The transform of a whole record, closed into a ring.
//!
//! A record with walk in it is not periodic. The line through its two ends is taken out first;
//! what is left of a random walk is a bridge, whose increments have the covariance of a circle,
//! exactly, so that its transform has independent ordinates at all frequencies, the lowest
//! included.
//!
//! Quantisation noise, a difference of neighbours, would need one more sample to close into a ring:
//! the first sample is set free ([`Transform::close`]), and with it that sum; so is the level across
//! the seam, which the line through noisy ends does not match exactly.

use std::sync::Arc;

use rayon::prelude::*;
use realfft::num_complex::Complex64;

use super::waveform::Waveform;
use crate::fft::ring::{Ring, Series};

/// Samples at each end that the line is laid through, at most: a choice. White noise of the ends is
/// 16 times less in their mean.
const END: usize = 256;

/// Ordinates that are worth a thread of their own: a choice.
pub(super) const SHARED: usize = 1 << 14;

/// The Fourier transform of a record, ordinate by ordinate.
pub struct Transform {
    pub(super) rate_hz: f64,
    pub(super) len: usize,
    pub(super) ordinates: Vec<Complex64>,
    pub(super) ring: Arc<Ring>,
}

/// Length that transforms fast: the largest even number with no prime factor above 5, at most
/// `len`.
pub fn smooth_len(len: usize) -> usize {
    (2..=len).rev().find(|&n| is_smooth(n)).unwrap_or(0)
}

/// The smallest such length that is at least `len`.
pub fn smooth_len_from(len: usize) -> usize {
    // There is a power of two.
    (len.max(2)..).find(|&n| is_smooth(n)).unwrap_or(len)
}

fn is_smooth(len: usize) -> bool {
    let mut rest = len;
    for prime in [2, 3, 5] {
        while rest.is_multiple_of(prime) {
            rest /= prime;
        }
    }
    rest == 1 && len.is_multiple_of(2)
}

/// Makes transforms of records of one length.
#[derive(Clone)]
pub struct Transformer {
    len: usize,
    ring: Arc<Ring>,
}

impl Transformer {
    /// For records of `len` samples, of which the first [`smooth_len`] are used.
    pub fn new(len: usize) -> Self {
        let len = smooth_len(len);
        Self {
            len,
            ring: Arc::new(Ring::new(len.max(2))),
        }
    }

    /// How many samples of a record are used.
    pub fn len(&self) -> usize {
        self.len
    }

    /// A copy of the samples of `values` that are used.
    pub fn series(&self, values: &[f64]) -> Series {
        Series::new(&values[..self.len])
    }

    /// A ring of zeros.
    pub fn zeros(&self) -> Series {
        Series::new(&vec![0.0; self.len])
    }

    /// A ring that begins with as many of `values` as it has room for, less the line that fits them best, and is zero from
    /// there on. A line through their ends would be a ramp of its own: of quantisation noise the sums know what a ramp leaves
    /// far below what a few samples at the ends scatter by.
    pub fn padded(&self, values: &[f64]) -> Series {
        let mut ring = self.zeros();
        let values = &values[..values.len().min(self.len)];
        ring[..values.len()].copy_from_slice(values);
        take_out_best_line(&mut ring[..values.len()]);
        ring
    }

    /// Gaussian noise of the two-sided densities `density` at the ordinates, made of standard `normal` numbers.
    pub fn noise(&self, density: &[f64], rate_hz: f64, normal: impl FnMut() -> f64) -> Series {
        let mut noise = self.transform_ring(self.zeros(), rate_hz);
        noise.add_noise(|k| density[k], normal);
        noise.series()
    }

    /// Transform of `values`, none of which is missing, less the line through their ends.
    pub fn transform(&self, values: &[f64], rate_hz: f64) -> Transform {
        self.transform_in_place(self.series(values), rate_hz)
    }

    /// The same of a series of [`Self::len`] samples, in its own memory.
    pub fn transform_in_place(&self, mut bridge: Series, rate_hz: f64) -> Transform {
        take_out_line(&mut bridge);
        self.transform_ring(bridge, rate_hz)
    }

    /// The same of a series that closes into a ring as it is.
    pub fn transform_ring(&self, ring: Series, rate_hz: f64) -> Transform {
        Transform {
            rate_hz,
            len: self.len,
            ordinates: self.ring.forward(ring),
            ring: Arc::clone(&self.ring),
        }
    }

    /// Transform of a waveform that begins with the ring.
    pub fn waveform(&self, waveform: &impl Waveform, rate_hz: f64) -> Transform {
        self.waveform_at(waveform, 0, rate_hz)
    }

    /// Transform of a waveform that begins with the sample `index`.
    pub fn waveform_at(&self, waveform: &impl Waveform, index: usize, rate_hz: f64) -> Transform {
        let shift = |k: usize| {
            let turns = (k as u64 * index as u64 % self.len as u64) as usize;
            if turns <= self.len / 2 {
                self.ring.turn(turns)
            } else {
                self.ring.turn(self.len - turns).conj()
            }
        };
        let at = |k: usize| match k {
            0 => Complex64::ZERO,
            _ => waveform.at(self.ring.turn(k)) * shift(k),
        };
        Transform {
            rate_hz,
            len: self.len,
            ordinates: (0..=self.len / 2).map(at).collect(),
            ring: Arc::clone(&self.ring),
        }
    }
}

/// Takes out the line through the means of both ends, so that the values can close into a ring.
fn take_out_line(values: &mut [f64]) {
    let end = END.min(values.len() / 8).max(1);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let (first, last) = (mean(&values[..end]), mean(&values[values.len() - end..]));
    let length = values.len() as f64;
    // The ends' means stand for the moments half an end inside.
    let slope = (last - first) / (length - end as f64);
    let middle = 0.5 * (first + last);
    for (index, value) in values.iter_mut().enumerate() {
        *value -= middle + slope * (index as f64 + 0.5 - 0.5 * length);
    }
}

/// Takes out the line of least squares.
fn take_out_best_line(values: &mut [f64]) {
    let count = values.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let moments = (0_u32..)
        .zip(&*values)
        .map(|(n, value)| (f64::from(n) - middle) * (value - mean));
    // The sum of the squared distances from the middle.
    let square = count * (count * count - 1.0) / 12.0;
    let slope = moments.sum::<f64>() / square.max(1.0);
    for (n, value) in (0_u32..).zip(values) {
        *value -= mean + slope * (f64::from(n) - middle);
    }
}

impl Transform {
    /// How many samples of the record were transformed.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Samples a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Ordinates from zero frequency to half the rate, `X_k = sum x_n e^{-2 pi i k n / N}`.
    pub fn ordinates(&self) -> &[Complex64] {
        &self.ordinates
    }

    /// Adds another record of the same ring.
    pub fn add(&mut self, other: &Self) {
        for (ordinate, other) in self.ordinates.iter_mut().zip(&other.ordinates) {
            *ordinate += other;
        }
    }

    /// Adds so many times another transform.
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        for (ordinate, other) in self.ordinates.iter_mut().zip(&other.ordinates) {
            *ordinate += factor * other;
        }
    }

    /// The same behind a filter of this amplitude at each ordinate, where there is one.
    #[must_use]
    pub fn behind(mut self, amplitude: Option<&[f64]>) -> Self {
        for (ordinate, passed) in self.ordinates.iter_mut().zip(amplitude.unwrap_or_default()) {
            *ordinate *= *passed;
        }
        self
    }

    /// Adds Gaussian noise of the two-sided density `density(k)`, made of standard `normal`
    /// numbers.
    pub fn add_noise(&mut self, density: impl Fn(usize) -> f64, mut normal: impl FnMut() -> f64) {
        for (k, ordinate) in self.ordinates.iter_mut().enumerate().skip(1) {
            let deviation = (0.5 * density(k) * self.rate_hz * self.len as f64).sqrt();
            *ordinate += Complex64::new(deviation * normal(), deviation * normal());
        }
    }

    /// Expected squared size of an ordinate where the density is 1.
    pub fn power(&self) -> f64 {
        self.rate_hz * self.len as f64
    }

    /// Frequency of an ordinate, hertz.
    pub fn frequency(&self, k: usize) -> f64 {
        k as f64 * self.rate_hz / self.len as f64
    }

    /// The record through the filter whose response at ordinate `k` is `response(k)`, which is
    /// asked above zero frequency; the mean is left out.
    pub fn filtered(&self, response: impl Fn(usize) -> Complex64 + Sync) -> Series {
        self.back(|k| self.ordinates[k] * response(k))
    }

    /// What the filter of that response makes of a single sample of size one at moment zero.
    pub fn answer(&self, response: impl Fn(usize) -> f64 + Sync) -> Series {
        self.back(|k| response(k).into())
    }

    /// The record itself.
    pub fn series(&self) -> Series {
        self.back(|k| self.ordinates[k])
    }

    /// Samples of a ring whose ordinates above zero frequency are `ordinate(k)`, its mean zero.
    fn back(&self, ordinate: impl Fn(usize) -> Complex64 + Sync) -> Series {
        let norm = (self.len as f64).recip();
        let all = (0..self.ordinates.len()).into_par_iter();
        let ordinates = all.with_min_len(SHARED).map(|k| match k {
            0 => Complex64::ZERO,
            _ => ordinate(k) * norm,
        });
        self.ring.inverse(ordinates.collect())
    }
}
