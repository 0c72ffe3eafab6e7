//! Matched filters over every moment of a record at once.
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

mod projection;
mod seam;
mod together;
mod transform;
mod waveform;

use crate::diagnosis::statistic::sums::sums;
use crate::fft::ring::Series;

pub use projection::{Half, Projection, held_out_gain};
pub use seam::Seam;
pub use together::together;
pub use transform::{Transform, Transformer, smooth_len, smooth_len_from};
pub use waveform::{Impulse, Settling, Step, Waveform};

/// What a matched filter says of every moment.
pub struct Match {
    /// Size of the waveform at every moment, in standard deviations of that size.
    pub z: Series,
    /// Standard deviation of the waveform's size.
    pub size_sd: f64,
    /// Expected crossings of zero in one direction a sample: sets the number of independent moments.
    pub crossings: f64,
}

/// The statistic of `waveform` at every moment, for noise of the two-sided densities `density`
/// at the ordinates.
pub fn matched(whole: &Transform, density: &[f64], waveform: &(impl Waveform + Sync)) -> Match {
    matched_behind(whole, density, waveform, |_| 1.0)
}

/// The same of a `waveform` behind a filter whose amplitude at ordinate `k` is `passed(k)`: what the filter shuts out says
/// nothing of the waveform, however little noise is there.
pub fn matched_behind(
    whole: &Transform,
    density: &[f64],
    waveform: &(impl Waveform + Sync),
    passed: impl Fn(usize) -> f64 + Sync,
) -> Match {
    let noise = |k: usize| density[k] * whole.rate_hz;
    let response = |k: usize| passed(k) * waveform.at(whole.ring.turn(k)).conj() / noise(k);
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
