//! One waveform that begins at several moments: its sizes, all at once.
//!
//! With `b_i = <x, g_i>` of the record and the waveform at moment `i`, and `G_ij = <g_i, g_j>`, which depends on the
//! distance alone, the likeliest sizes together are `a = G^-1 b`, of covariance `G^-1`.

use nalgebra::{DMatrix, DVector};

use super::Transform;

/// Sizes of a waveform that begins at several moments.
pub struct Together {
    /// The size at each moment, in the unit of the record.
    pub sizes: Vec<f64>,
    /// Its standard deviation, the others not known.
    pub size_sds: Vec<f64>,
}

/// The sizes that a waveform has together at these `moments`, samples of the ring of `whole`, in noise of the two-sided
/// densities `density`; `waveform` is as it is where it begins with the ring. `None` where the record cannot tell them
/// apart.
pub fn together(
    whole: &Transform,
    density: &[f64],
    waveform: &Transform,
    moments: &[usize],
) -> Option<Together> {
    let noise = |k: usize| density[k] * whole.rate_hz;
    let products = whole.filtered(|k| waveform.ordinates[k].conj() / noise(k));
    let products = DVector::from_iterator(moments.len(), moments.iter().map(|&n| products[n]));
    let shared = whole.answer(|k| waveform.ordinates[k].norm_sqr() / noise(k));
    let gram = DMatrix::from_fn(moments.len(), moments.len(), |row, column| {
        shared[moments[row].abs_diff(moments[column])]
    });
    let factors = gram.cholesky()?;
    let sizes = factors.solve(&products);
    let covariance = factors.inverse();
    Some(Together {
        sizes: sizes.iter().copied().collect(),
        size_sds: covariance.diagonal().iter().map(|one| one.sqrt()).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::statistic::matched_filter::{
        Half, Impulse, Projection, Step, Transformer, Waveform,
    };
    use crate::model::random::{Gaussian, Seed};

    const LENGTH: usize = 1 << 12;
    const RATE_HZ: f64 = 2.0;

    fn of(waveform: &(impl Waveform + Sync)) -> Transform {
        Transformer::new(LENGTH).waveform(waveform, RATE_HZ)
    }

    fn record(seed: u64, moments: &[usize], sizes: &[f64]) -> Transform {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut values: Vec<f64> = (0..LENGTH).map(|_| noise.draw()).collect();
        for (&moment, size) in moments.iter().zip(sizes) {
            values[moment..].iter_mut().for_each(|value| *value += size);
        }
        Transformer::new(LENGTH).transform(&values, RATE_HZ)
    }

    #[test]
    fn neighbours_are_told_apart() {
        let (moments, sizes) = ([1000, 1016, 3000], [2.0, -1.5, 1.0]);
        let density = vec![1.0 / RATE_HZ; LENGTH / 2 + 1];
        for seed in 0..20 {
            let whole = record(seed, &moments, &sizes);
            let found = together(&whole, &density, &of(&Step), &moments);
            let found = found.expect("they are apart");
            for ((found, sd), size) in found.sizes.iter().zip(&found.size_sds).zip(sizes) {
                // Of sixty normal numbers one lies beyond 5 in 30 000 runs.
                assert!((found - size).abs() < 5.0 * sd, "seed {seed}: {found} {sd}");
            }
        }
    }

    #[test]
    fn one_by_itself_is_a_projection() {
        let density: Vec<f64> = (0..=LENGTH / 2)
            .map(|k| 0.1 + k as f64 / LENGTH as f64)
            .collect();
        let whole = record(1, &[], &[]);
        let found = together(&whole, &density, &of(&Impulse), &[700]).expect("one");
        let wave = Transformer::new(LENGTH).waveform_at(&Impulse, 700, RATE_HZ);
        let one = Projection::new(&whole, &density, &wave, Half::Both);
        // The last ordinate counts half as much on the ring as a projection has it: 2048 share the sum.
        assert!((found.size_sds[0] / one.size_sd() - 1.0).abs() < 1e-3);
        assert!((found.sizes[0] - one.size()).abs() < 2e-3 * one.size_sd() * f64::sqrt(2048.0));
    }

    #[test]
    fn what_begins_at_one_moment_twice_cannot_be_told_apart() {
        let density = vec![1.0 / RATE_HZ; LENGTH / 2 + 1];
        let whole = record(2, &[], &[]);
        assert!(together(&whole, &density, &of(&Step), &[700, 700]).is_none());
    }
}
