//! A record and noise drawn from its law, on a ring with room for both ends.
//!
//! What is missing of a record `x` is drawn as noise `z` of its law has it between the samples that are there: `z` moved
//! there by the likeliest values of `x - z` (conditioning by kriging: J.-P. Chiles and P. Delfiner, *Geostatistics*, 2012,
//! section 7.3.1).

use std::ops::Range;

use crate::diagnosis::statistic::kriging::Unknown;
use crate::diagnosis::statistic::matched_filter::{Transformer, smooth_len_from};
use crate::fft::ring::Series;
use crate::model::Seed;
use crate::model::random::Gaussian;

/// Any seed is as good as another; the same one each time, so that a record has one answer.
const SEED: Seed = Seed { seed: 1, stream: 0 };

/// Samples behind the end of the record and ahead of its begin that no one knows, where it is closed into a ring: a
/// choice, as far as the converter's filter spreads a sample.
const SEAM: usize = 64;

/// The ring of records of one length.
pub struct Drawn {
    ring: Transformer,
    len: usize,
}

impl Drawn {
    /// For records of `len` samples.
    pub fn new(len: usize) -> Self {
        Self {
            ring: Transformer::new(smooth_len_from(len + SEAM)),
            len,
        }
    }

    /// Samples of the ring at whose ordinates densities are wanted.
    pub fn ring_len(&self) -> usize {
        self.ring.len()
    }

    /// Places of the ring behind the record and ahead of it that count as missing.
    pub fn seam(&self) -> [Range<usize>; 2] {
        let (end, len) = (self.len, self.ring.len());
        [end..end + SEAM, (len - SEAM).max(end + SEAM)..len]
    }

    /// `values`, none of which is missing, less noise of the two-sided densities `density` at the ordinates.
    pub fn off(&self, values: &[f64], rate_hz: f64, density: &[f64]) -> Series {
        let mut normal = Gaussian::new(SEED, 1.0);
        let noise = self.ring.noise(density, rate_hz, || normal.draw());
        let mut off = self.ring.padded(values);
        let pairs = off.iter_mut().zip(noise.iter());
        let pairs = pairs.take(self.len);
        pairs.for_each(|(off, noise)| *off -= noise);
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

    /// By how much a closed ring has to be moved at these `places` to be the likeliest there.
    pub fn moves(&self, off: Series, places: &[usize], rate_hz: f64, density: &[f64]) -> Vec<f64> {
        let off = self.ring.transform_ring(off, rate_hz);
        Unknown::at(&self.ring, places, density).moves(&off)
    }
}
