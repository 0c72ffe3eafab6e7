//! A record and noise drawn from its law, on a ring with room for both ends.
//!
//! What is missing of a record `x` is drawn as noise `z` of its law has it between the samples that are there: `z` moved
//! there by the likeliest values of `x - z` (conditioning by kriging: J.-P. Chiles and P. Delfiner, *Geostatistics*, 2012,
//! section 7.3.1).

use std::ops::Range;

use crate::diagnosis::statistic::kriging::Unknown;
use crate::diagnosis::statistic::matched_filter::{Transform, Transformer, smooth_len_from};
use crate::fft::ring::Series;
use crate::model::Seed;
use crate::model::random::Gaussian;

/// Samples behind the end of the record and ahead of its begin that no one knows, where it is closed into a ring, at least: a
/// choice, as far as the converter's filter spreads a sample.
const SEAM: usize = 64;

/// Part of the record that they are, and how many at most: choices. The phase in which a tone ends says little of that in
/// which it began, and as far as it goes on by itself from either end what is drawn there would have to bend it.
const PART: usize = 32;
const LONGEST_SEAM: usize = 4096;

/// Noise to draw from.
#[derive(Clone, Copy)]
pub struct Noise<'a> {
    /// Samples a second.
    pub rate_hz: f64,
    /// Its two-sided densities at the ordinates of the ring, per hertz.
    pub density: &'a [f64],
    /// Factor on its standard deviation at a sample, whose mean square over the record is one.
    pub strength: &'a dyn Fn(usize) -> f64,
}

/// The ring of a record.
pub struct Drawn {
    ring: Transformer,
    len: usize,
    /// Samples of the seam on either side.
    seam: usize,
    /// Where its random numbers begin.
    seed: Seed,
}

impl Drawn {
    /// For a record that was `measured` so, with NaN for what is missing.
    pub fn of(measured: &[f64]) -> Self {
        let seam = (measured.len() / PART).clamp(SEAM, LONGEST_SEAM);
        Self {
            ring: Transformer::new(smooth_len_from(measured.len() + seam)),
            len: measured.len(),
            seam,
            seed: seed(measured),
        }
    }

    /// Samples of the ring at whose ordinates densities are wanted.
    pub fn ring_len(&self) -> usize {
        self.ring.len()
    }

    /// Places of the ring behind the record and ahead of it that count as missing.
    pub fn seam(&self) -> [Range<usize>; 2] {
        let (end, len) = (self.len, self.ring.len());
        [
            end..end + self.seam,
            (len - self.seam).max(end + self.seam)..len,
        ]
    }

    /// `values`, none of which is missing, less `noise` as it may be.
    pub fn off(&self, values: &[f64], noise: &Noise<'_>) -> Series {
        let mut normal = Gaussian::new(self.seed, 1.0);
        let drawn = self
            .ring
            .noise(noise.density, noise.rate_hz, || normal.draw());
        let mut off = self.ring.padded(values);
        let pairs = off.iter_mut().zip(drawn.iter()).take(self.len);
        for (n, (off, drawn)) in pairs.enumerate() {
            *off -= (noise.strength)(n) * drawn;
        }
        off
    }

    /// Closes what begins with a record by a straight line from the mean of its end to that of its begin.
    pub fn close(&self, off: &mut [f64]) {
        let end = SEAM.min(self.len / 2).max(1);
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let (to, from) = (mean(&off[..end]), mean(&off[self.len - end..self.len]));
        let step = (to - from) / (off.len() - self.len + 1) as f64;
        for (n, value) in off[self.len..].iter_mut().enumerate() {
            *value = from + step * (n + 1) as f64;
        }
    }

    /// One at its first sample, and zero elsewhere.
    pub fn impulse(&self, rate_hz: f64) -> Transform {
        let mut one = self.ring.zeros();
        one[0] = 1.0;
        self.ring.transform_ring(one, rate_hz)
    }

    /// Normal numbers for what is drawn beyond a limit: the same for the same record, and others than its noise.
    pub fn numbers(&self) -> Gaussian {
        Gaussian::new(
            Seed {
                stream: 1,
                ..self.seed
            },
            1.0,
        )
    }

    /// The ring of `values`, none of which is missing, closed.
    pub fn closed(&self, values: &[f64], rate_hz: f64) -> Transform {
        let mut whole = self.ring.padded(values);
        self.close(&mut whole);
        self.ring.transform_ring(whole, rate_hz)
    }

    /// By how much a closed ring has to be moved at these `places` to be the likeliest there, of noise that is as strong all along.
    pub fn moves(&self, off: Series, places: &[usize], noise: &Noise<'_>) -> Vec<f64> {
        let off = self.ring.transform_ring(off, noise.rate_hz);
        Unknown::at(&self.ring, places, noise.density).moves(&off)
    }
}

/// The same for the same record, so that it has one answer, and another for every other: samples that all axes miss are drawn
/// for each by itself, or their noise would seem to be the same.
fn seed(measured: &[f64]) -> Seed {
    /// Of the hash FNV-1a for 64 bits (G. Fowler, L. C. Noll, K.-P. Vo).
    const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01b3;
    let there = measured.iter().filter(|value| value.is_finite());
    let seed = there.fold(BASIS, |hash, value| {
        (hash ^ value.to_bits()).wrapping_mul(PRIME)
    });
    Seed { seed, stream: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_records_that_miss_the_same_samples_share_nothing_of_what_is_drawn() {
        const LEN: usize = 4000;
        let record = |seed| {
            let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
            let every_third = |n| if n % 3 == 0 { f64::NAN } else { normal.draw() };
            (0..LEN).map(every_third).collect::<Vec<f64>>()
        };
        let (one, other) = (record(1), record(2));
        let noise = |measured: &[f64]| {
            let drawn = Drawn::of(measured);
            let density = vec![1.0; drawn.ring_len() / 2 + 1];
            let noise = Noise {
                rate_hz: 1.0,
                density: &density,
                strength: &|_| 1.0,
            };
            drawn.off(&[0.0; LEN], &noise).to_vec()
        };
        let pairs = || noise(&one).into_iter().zip(noise(&other)).take(LEN);
        let correlation = pairs().map(|(a, b)| a * b).sum::<f64>() / LEN as f64;
        // Of independent normal numbers, five deviations.
        let limit = 5.0 / (LEN as f64).sqrt();
        assert!(correlation.abs() < limit, "{correlation}, seeds 1 and 2");
        // A record has one answer.
        assert_eq!(noise(&one), noise(&one));
    }
}
