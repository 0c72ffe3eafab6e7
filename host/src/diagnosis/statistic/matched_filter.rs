//! The transform of a whole record: matched filters over every moment at once.
//!
//! A record with walk in it is not periodic. The line through its two ends is taken out first;
//! what is left of a random walk is a bridge, whose increments have the covariance of a circle,
//! exactly, so that its transform has independent ordinates at all frequencies, the lowest
//! included.
//!
//! For noise of two-sided density `S(f)` the best linear statistic for a waveform `g` that begins at
//! moment `t` is (Kay, *Fundamentals of Statistical Signal Processing* II, 1998, ch. 5)
//!
//! ```text
//! z(t) = <x, g_t> / sqrt(<g, g>),    <a, b> = (1/N) sum_k A_k conj(B_k) / (S(f_k) rate)
//! ```
//!
//! which is standard normal where `g` is absent, and gives the waveform's size as
//! `<x, g_t> / <g, g>`.
//!
//! Quantisation noise, a difference of neighbours, would need one more sample to close into a ring:
//! the first sample is set free ([`Transform::close`]), and with it that sum; so is the level across
//! the seam, which the line through noisy ends does not match exactly.
//!
//! Ordinates with even and with odd numbers are independent of one another and see the same hours:
//! what a waveform is worth on unseen data is measured by fitting it to the one half and judging the
//! other.

use std::sync::Arc;

use rayon::prelude::*;
use realfft::num_complex::Complex64;

use crate::diagnosis::statistic::sums::sums;
use crate::fft::ring::{Ring, Series};

/// Samples at each end that the line is laid through, at most: a choice. White noise of the ends is
/// 16 times less in their mean.
const END: usize = 256;

/// Ordinates that are worth a thread of their own: a choice.
const SHARED: usize = 1 << 14;

/// The Fourier transform of a record, ordinate by ordinate.
pub struct Transform {
    rate_hz: f64,
    len: usize,
    ordinates: Vec<Complex64>,
    ring: Arc<Ring>,
}

/// Length that transforms fast: the largest even number with no prime factor above 5, at most
/// `len`.
pub fn smooth_len(len: usize) -> usize {
    let is_smooth = |mut n: usize| {
        for prime in [2, 3, 5] {
            while n.is_multiple_of(prime) {
                n /= prime;
            }
        }
        n == 1
    };
    (2..=len)
        .rev()
        .find(|&n| n.is_multiple_of(2) && is_smooth(n))
        .unwrap_or(0)
}

/// Makes transforms of records of one length.
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

    /// Transform of `values`, none of which is missing, less the line through their ends.
    pub fn transform(&self, values: &[f64], rate_hz: f64) -> Transform {
        self.transform_in_place(self.series(values), rate_hz)
    }

    /// The same of a series of [`Self::len`] samples, in its own memory.
    pub fn transform_in_place(&self, mut bridge: Series, rate_hz: f64) -> Transform {
        take_out_line(&mut bridge);
        Transform {
            rate_hz,
            len: self.len,
            ordinates: self.ring.forward(bridge),
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

    /// Sets the seam free: the first sample takes the value, and the level across the seam the
    /// step, that all others predict for them.
    pub fn close(&mut self, density: &[f64]) {
        let ring = Arc::clone(&self.ring);
        let step = |k: usize| Step.at(ring.turn(k));
        // Normal equations of both, over half of the ring.
        let [right, right_of_step, one, of_step, square] = sums(1..self.ordinates.len(), |k| {
            let (ordinate, weight, step) = (self.ordinates[k], density[k].recip(), step(k));
            [
                ordinate.re,
                (ordinate * step.conj()).re,
                1.0,
                step.re,
                step.norm_sqr(),
            ]
            .map(|term| term * weight)
        });
        let determinant = one * square - of_step * of_step;
        let sample = (right * square - right_of_step * of_step) / determinant;
        let height = (right_of_step * one - right * of_step) / determinant;
        if !(sample.is_finite() && height.is_finite()) {
            return;
        }
        let ordinates = self.ordinates.par_iter_mut().with_min_len(SHARED);
        let ordinates = ordinates.enumerate().skip(1);
        ordinates.for_each(|(k, ordinate)| *ordinate -= sample + height * step(k));
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

/// Transform of a waveform that begins at moment zero, as the filters need it.
pub trait Waveform {
    /// Its transform where one sample later is a factor of `turn = e^{-2 pi i f / rate}`.
    fn at(&self, turn: Complex64) -> Complex64;
}

/// A single sample of size 1.
pub struct Impulse;

impl Waveform for Impulse {
    fn at(&self, _turn: Complex64) -> Complex64 {
        Complex64::ONE
    }
}

/// A jump by 1 that stays.
pub struct Step;

impl Waveform for Step {
    fn at(&self, turn: Complex64) -> Complex64 {
        // On the ring, where the mean is not seen.
        (Complex64::ONE - turn).inv()
    }
}

/// Exponential settling, sampled half a sample after it began.
pub struct Settling {
    /// Time constant, samples.
    pub samples: f64,
    /// Samples of the ring, at whose end it breaks off.
    pub len: usize,
}

impl Waveform for Settling {
    fn at(&self, turn: Complex64) -> Complex64 {
        let kept = (-1.0 / self.samples).exp();
        let size = kept.sqrt() * -(-(self.len as f64) / self.samples).exp_m1();
        size * (Complex64::ONE - kept * turn).inv()
    }
}

/// What a matched filter says of every moment.
pub struct Match {
    /// Size of the waveform at every moment, in standard deviations of that size.
    pub z: Series,
    /// Standard deviation of the waveform's size.
    pub size_sd: f64,
    /// Expected crossings of zero in one direction a sample: sets the number of independent moments.
    pub crossings: f64,
}

/// Which ordinates a statistic looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Half {
    /// All ordinates.
    Both,
    /// The ordinates with even numbers.
    Even,
    /// The ordinates with odd numbers.
    Odd,
}

impl Half {
    /// Whether it has ordinate `k`.
    pub const fn has(self, k: usize) -> bool {
        match self {
            Self::Both => true,
            Self::Even => k.is_multiple_of(2),
            Self::Odd => !k.is_multiple_of(2),
        }
    }
}

/// The statistic of `waveform` at every moment, for noise of the two-sided densities `density`
/// at the ordinates.
pub fn matched(whole: &Transform, density: &[f64], waveform: &(impl Waveform + Sync)) -> Match {
    let noise = |k: usize| density[k] * whole.rate_hz;
    let response = |k: usize| waveform.at(whole.ring.turn(k)).conj() / noise(k);
    let [information, curvature] = sums(1..whole.ordinates.len(), |k| {
        // A density without end leaves an ordinate out.
        if !noise(k).is_finite() {
            return [0.0; 2];
        }
        let both = if 2 * k == whole.len { 1.0 } else { 2.0 };
        let share = both * response(k).norm_sqr() * noise(k) / whole.len as f64;
        let turn = std::f64::consts::TAU * k as f64 / whole.len as f64;
        [share, share * turn.powi(2)]
    });
    let size_sd = information.sqrt().recip();
    Match {
        z: whole.filtered(|k| response(k) * size_sd),
        size_sd,
        crossings: (curvature / information).sqrt() / std::f64::consts::TAU,
    }
}

impl Match {
    /// What the ordinates with even numbers and those with odd ones say of the waveform at moment `n`, by
    /// itself: what has only even ones repeats after half of the ring, what has only odd ones changes its
    /// sign there. Either half has half of the information, where that is smooth.
    pub fn halves(&self, n: usize) -> [Projection; 2] {
        let half = self.z.len() / 2;
        let opposite = self.z[if n < half { n + half } else { n - half }];
        [opposite, -opposite].map(|opposite| Projection {
            product: 0.5 * (self.z[n] + opposite) / self.size_sd,
            power: 0.5 / self.size_sd.powi(2),
        })
    }
}

/// `<x, g>` and `<g, g>` of a record and one waveform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// `<x, g>`.
    pub product: f64,
    /// `<g, g>`.
    pub power: f64,
}

impl Projection {
    /// Of `record` on `wave`, both transforms of the same length.
    pub fn new(record: &Transform, density: &[f64], wave: &Transform, half: Half) -> Self {
        let [product, power] = sums(1..record.ordinates.len(), |k| {
            if !half.has(k) {
                return [0.0; 2];
            }
            let (x, g) = (record.ordinates[k], wave.ordinates[k]);
            [(x * g.conj()).re, g.norm_sqr()].map(|term| term / density[k])
        });
        // The sums run over half of the ring.
        let norm = 0.5 * record.len as f64 * record.rate_hz;
        Self {
            product: product / norm,
            power: power / norm,
        }
    }

    /// Size of the waveform, in standard deviations of that size.
    pub fn z(self) -> f64 {
        self.product / self.power.sqrt()
    }

    /// Size of the waveform.
    pub fn size(self) -> f64 {
        self.product / self.power
    }

    /// Standard deviation of the size.
    pub fn size_sd(self) -> f64 {
        self.power.sqrt().recip()
    }

    /// Gain in log-likelihood if the waveform has the size `size`, fitted elsewhere.
    pub fn gain(self, size: f64) -> f64 {
        size * self.product - 0.5 * size * size * self.power
    }
}

/// Gain of a waveform in log-likelihood on the odd ordinates, its size fitted to the even ones.
pub fn held_out_gain(record: &Transform, density: &[f64], wave: &Transform) -> f64 {
    let seen = Projection::new(record, density, wave, Half::Even);
    Projection::new(record, density, wave, Half::Odd).gain(seen.size())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    #[test]
    fn both_halves_are_in_the_whole_answer() {
        const LENGTH: usize = 1 << 12;
        let mut noise = Gaussian::new(Seed { seed: 1, stream: 0 }, 1.0);
        let mut values: Vec<f64> = (0..LENGTH).map(|_| noise.draw()).collect();
        values[3000] += 20.0;
        let transformer = Transformer::new(LENGTH);
        let record = transformer.transform(&values, 2.0);
        // Noise that rises with the frequency, by little from one ordinate to the next.
        let density: Vec<f64> = (0..=LENGTH / 2)
            .map(|k| 0.1 + k as f64 / LENGTH as f64)
            .collect();
        let found = matched(&record, &density, &Impulse);
        for n in [5, 1000, 2048, 3000] {
            let wave = transformer.waveform_at(&Impulse, n, 2.0);
            let halves = [Half::Even, Half::Odd].map(|half| {
                // The last ordinate counts half as much on the ring as a projection has it.
                Projection::new(&record, &density, &wave, half)
            });
            for (one, other) in found.halves(n).into_iter().zip(halves) {
                // One ordinate of two thousand, at 1 / 0.6 of a mean weight of 1 / 0.28.
                let off = one.product - other.product;
                assert!(off.abs() < 0.02 * other.power.sqrt(), "{n}: {off}, seed 1");
                assert!((one.power / other.power - 1.0).abs() < 2e-3, "{n}, seed 1");
            }
        }
    }
}
