//! Several axes together: cross-spectra and coherence from the same transforms.
//!
//! Every axis has its own [`Cascade`]; since segments lie on the grid of the absolute index, the
//! transforms of two axes that carry the same number are of the same stretch of time. With
//! `z = a + i b` holding two neighbouring segments of each axis,
//! `X_a Y_a* + X_b Y_b* = (Zx_k Zy_k* + (Zx_{N-k})* Zy_{N-k}) / 2`,
//! so the pairs need no separation here either. A segment counts only where it is whole on both
//! axes; the axes' own powers are summed over the same segments, so that the coherence never
//! exceeds one.

mod products;

use rustfft::num_complex::Complex64;

use super::{
    cascade::{Cascade, OutOfOrder},
    decimate::{FACTOR, PASS},
    segments::{HOP, LEN, Pair, Plan},
};
use products::{Slot, Sums};

/// Samples pushed at once: no level completes more than one segment from them.
const PIECE: usize = HOP;

/// Lowest bin of a segment that is used.
const LOWEST_BIN: usize = 6;

/// Streaming spectra of several axes with their cross-spectra.
#[derive(Debug, Clone)]
pub struct CrossCascade {
    plan: Plan,
    axes: Vec<Cascade>,
    /// `[axis][level]`.
    slots: Vec<Vec<Slot>>,
    /// `[pair][level]`, pairs in the order (0,1), (0,2), (1,2), ...
    sums: Vec<Vec<Sums>>,
}

/// Cross-spectrum of two axes at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossBin {
    /// Mean frequency, hertz.
    pub f_hz: f64,
    /// Two-sided cross density `E[X Y*]`, product of the axes' units per hertz.
    pub density: Complex64,
    /// Squared coherence, 0 to 1.
    pub coherence: f64,
    /// Independent products in the average, `n`: without coherence the estimate exceeds `c` with
    /// probability `(1 - c)^(n - 1)` (Carter 1987, eq. 34).
    pub averages: f64,
}

impl CrossCascade {
    /// For `axes` axes.
    pub fn new(axes: usize) -> Self {
        let plan = Plan::new();
        Self {
            axes: (0..axes).map(|_| Cascade::new(&plan)).collect(),
            slots: vec![Vec::new(); axes],
            sums: vec![Vec::new(); axes * axes.saturating_sub(1) / 2],
            plan,
        }
    }

    /// Takes one block of every axis; `first` is the absolute index of the first sample. Values
    /// that are not finite are gaps of their axis alone. Missing columns are gaps.
    ///
    /// # Errors
    /// [`OutOfOrder`] if `first` lies before the end of an earlier block.
    pub fn push(&mut self, first: u64, columns: &[&[f64]]) -> Result<(), OutOfOrder> {
        let len = columns.iter().map(|column| column.len()).max().unwrap_or(0);
        for start in (0..len).step_by(PIECE) {
            let at = first + start as u64;
            for ((axis, slots), column) in self.axes.iter_mut().zip(&mut self.slots).zip(columns) {
                let end = (start + PIECE).min(column.len());
                if start < end {
                    let mut keep = |pair: Pair<'_>| Slot::store(slots, &pair);
                    axis.push_with(at, &column[start..end], |x| x, &mut keep)?;
                }
            }
            self.multiply();
        }
        Ok(())
    }

    /// Adds the products of all transforms that two axes have in common.
    fn multiply(&mut self) {
        let mut pair = 0;
        for first in 0..self.slots.len() {
            for second in first + 1..self.slots.len() {
                let levels = self.slots[first].iter().zip(&self.slots[second]);
                for (level, (one, other)) in levels.enumerate() {
                    let sums = &mut self.sums[pair];
                    if sums.len() == level {
                        sums.push(Sums::new());
                    }
                    if one.index.is_some() && one.index == other.index {
                        sums[level].add(&self.plan, one, other);
                    }
                }
                pair += 1;
            }
        }
        // What was not met by the other axes in this piece is met never: pieces are in step.
        for slot in self.slots.iter_mut().flatten() {
            slot.index = None;
        }
    }

    /// Cross-spectrum of two axes sampled at `rate_hz`, by ascending frequency, with
    /// `bins_per_octave`. Empty if the axes are the same, do not exist, or share no segment.
    pub fn cross(
        &self,
        one: usize,
        other: usize,
        rate_hz: f64,
        bins_per_octave: f64,
    ) -> Vec<CrossBin> {
        let (low, high) = (one.min(other), one.max(other));
        let count = self.axes.len();
        if low == high || high >= count {
            return Vec::new();
        }
        let number = low * (2 * count - low - 1) / 2 + high - low - 1;
        let levels = &self.sums[number];
        let ratio = (1.0 / bins_per_octave.max(0.1)).exp2();
        let mut bins = Vec::new();
        for (level, sums) in levels
            .iter()
            .enumerate()
            .filter(|(_, sums)| sums.segments > 1)
        {
            let top = if level == 0 {
                LEN / 2 - 2
            } else {
                (PASS * LEN as f64) as usize
            };
            // The next level takes over where it has segments.
            let next = levels.get(level + 1).is_some_and(|next| next.segments > 1);
            let mut k = if next {
                top.min((PASS * LEN as f64) as usize) / FACTOR as usize + 1
            } else {
                LOWEST_BIN
            };
            while k <= top {
                let end = ((k as f64 * ratio) as usize).clamp(k + 1, top + 1);
                bins.push(sums.bin(
                    k..end,
                    rate_hz / (FACTOR as f64).powi(level as i32),
                    one > other,
                ));
                k = end;
            }
        }
        bins.sort_by(|a, b| a.f_hz.total_cmp(&b.f_hz));
        bins
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    /// Two axes that share half of their power, and one of its own.
    fn axes(seed: u64, len: usize) -> [Vec<f64>; 3] {
        let mut rng = rand_pcg::Pcg64::new(u128::from(seed), 9);
        let mut draw =
            || -> Vec<f64> { (0..len).map(|_| StandardNormal.sample(&mut rng)).collect() };
        let (common, a, b, c) = (draw(), draw(), draw(), draw());
        let add = |noise: &[f64], gain: f64| {
            noise
                .iter()
                .zip(&common)
                .map(|(n, s)| n + gain * s)
                .collect()
        };
        [add(&a, 1.0), add(&b, -1.0), c]
    }

    #[test]
    fn coherence_and_sign_of_a_shared_part() {
        let seed = 41;
        let [x, mut y, z] = axes(seed, 400_000);
        y[123_456] = f64::NAN;
        let mut cascade = CrossCascade::new(3);
        for start in (0..400_000).step_by(3333) {
            let end = (start + 3333).min(400_000);
            cascade
                .push(
                    start as u64,
                    &[&x[start..end], &y[start..end], &z[start..end]],
                )
                .unwrap();
        }
        // The bad sample costs the pair exactly the segments that it breaks.
        assert_eq!(cascade.sums[0][0].segments, cascade.sums[1][0].segments - 2);
        let (mut beyond, mut bins) = (0, 0);
        for bin in cascade.cross(0, 1, 2.0, 4.0) {
            // Squared coherence 1/4: its standard deviation is sqrt(2 c / n) (1 - c).
            let sigma = (0.5 / bin.averages).sqrt() * 0.75;
            let error = bin.coherence - 0.25;
            assert!(
                error.abs() < 5.0 * sigma + 1.0 / bin.averages,
                "seed {seed}: {bin:?}"
            );
            // Density -1/2 (variance 1 over 2 Hz), real.
            let sigma = (0.625 / bin.averages).sqrt();
            assert!(
                (bin.density.re + 0.5).abs() < 5.0 * sigma,
                "seed {seed}: {bin:?}"
            );
            assert!(bin.density.im.abs() < 5.0 * sigma, "seed {seed}: {bin:?}");
        }
        for bin in cascade.cross(2, 0, 2.0, 4.0) {
            bins += 1;
            // Each exceeds this with probability 0.01.
            let bound = 1.0 - 0.01_f64.powf(1.0 / (bin.averages - 1.0));
            beyond += usize::from(bin.coherence > bound);
        }
        assert!(bins > 30 && beyond <= 4, "seed {seed}: {beyond} of {bins}");
        assert!(cascade.cross(1, 1, 2.0, 4.0).is_empty());
        assert!(cascade.cross(0, 3, 2.0, 4.0).is_empty());
    }

    #[test]
    fn equal_axes_are_fully_coherent() {
        let [x, ..] = axes(7, 20_000);
        let mut cascade = CrossCascade::new(2);
        cascade.push(0, &[&x, &x]).unwrap();
        for bin in cascade.cross(0, 1, 1.0, 3.0) {
            assert!((bin.coherence - 1.0).abs() < 1e-12, "{bin:?}");
        }
    }
}
