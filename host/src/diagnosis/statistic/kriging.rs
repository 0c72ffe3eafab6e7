//! The likeliest values of what is missing, given all that is there.
//!
//! In noise of the density `S(f)` on a ring, with `P`, the circulant matrix with the spectrum `1 / S`, the likeliest
//! values `x_M` at the places `M` that are missing are those with
//!
//! ```text
//! [P x]_M = 0,    x as measured elsewhere
//! ```
//!
//! (simple kriging: J.-P. Chiles and P. Delfiner, *Geostatistics*, 2012, section 3.3), solved by conjugate gradients
//! (M. R. Hestenes and E. Stiefel, J. Res. NBS 49 (1952) 409).

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::diagnosis::statistic::matched_filter::{Transform, Transformer};
use crate::numeric::product::dot;

/// Turns of the solution at most: no gap of a few dozen samples needs more, but many different ones may.
const TURNS: usize = 64;

/// What the last turn may gain, as a part of a degree of freedom for each sample that is missing: a choice. A sample
/// then moves by some three thousandths of what it is not known by, the root of it.
const LAST: f64 = 1e-5;

/// Samples of a run that are solved for at once, at most: a choice, twice what a converter's filter makes of a jump. The
/// time that takes grows with the third power.
const LONGEST_RUN: usize = 256;

/// Samples of a ring that are not known.
pub struct Unknown<'a> {
    ring: Transformer,
    places: Cow<'a, [usize]>,
    density: &'a [f64],
}

impl<'a> Unknown<'a> {
    /// Those at these `places` of a ring, ascending; `density` is the two-sided one of the law at every ordinate.
    pub fn at(ring: &Transformer, places: &'a [usize], density: &'a [f64]) -> Self {
        Self {
            ring: ring.clone(),
            places: places.into(),
            density,
        }
    }

    /// Those in stretches of the ring that has a `density` at each of its ordinates.
    pub fn within(density: &'a [f64], stretches: &[Range<usize>]) -> Self {
        let mut places: Vec<usize> = stretches.iter().cloned().flatten().collect();
        places.sort_unstable();
        places.dedup();
        Self {
            ring: Transformer::new(2 * (density.len() - 1)),
            places: places.into(),
            density,
        }
    }

    /// Their numbers, ascending.
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// A record that has `values` at these places and is zero elsewhere.
    pub fn series(&self, values: &[f64], rate_hz: f64) -> Transform {
        let mut series = self.ring.zeros();
        for (&place, value) in self.places.iter().zip(values) {
            series[place] = *value;
        }
        self.ring.transform_ring(series, rate_hz)
    }

    /// By how much the samples of `record` at these places are to be moved so that they are the likeliest, all others as
    /// they are.
    pub fn moves(&self, record: &Transform) -> Vec<f64> {
        let wanted = self.at_places(record).into_iter().map(|one| -one);
        self.solve(wanted.collect(), record.rate_hz())
    }

    /// `P` times a record, there.
    fn at_places(&self, record: &Transform) -> Vec<f64> {
        let whole = record.filtered(|k| self.density[k].recip().into());
        self.places.iter().map(|&place| whole[place]).collect()
    }

    /// `P` times what is zero elsewhere, there.
    fn times(&self, values: &[f64], rate_hz: f64) -> Vec<f64> {
        self.at_places(&self.series(values, rate_hz))
    }

    /// What `P` turns into `wanted`.
    fn solve(&self, wanted: Vec<f64>, rate_hz: f64) -> Vec<f64> {
        let runs = Runs::new(self);
        let mut found = vec![0.0; wanted.len()];
        let mut left = wanted;
        let mut towards = runs.solve(&left);
        let mut square = dot(&left, &towards);
        for _ in 0..TURNS {
            let turned = self.times(&towards, rate_hz);
            let far = square / dot(&towards, &turned);
            // What this turn gains of `e' P e`, which has the mean `n rate`.
            let gain = far * square;
            if gain.is_nan() {
                break;
            }
            for n in 0..found.len() {
                found[n] += far * towards[n];
                left[n] -= far * turned[n];
            }
            if gain <= LAST * rate_hz * found.len() as f64 {
                break;
            }
            let solved = runs.solve(&left);
            let next = dot(&left, &solved);
            for n in 0..found.len() {
                towards[n] = solved[n] + next / square * towards[n];
            }
            square = next;
        }
        found
    }
}

/// What `P` would be if runs of missing samples knew nothing of each other: it makes the conjugate gradients begin where
/// only neighbouring runs have to agree.
struct Runs {
    /// Numbers of the places, run by run.
    runs: Vec<Range<usize>>,
    /// `P` of a run of each length, decomposed.
    parts: BTreeMap<usize, Cholesky<f64, Dyn>>,
}

impl Runs {
    fn new(precision: &Unknown<'_>) -> Self {
        let places = &precision.places;
        let mut runs: Vec<Range<usize>> = Vec::new();
        for n in 0..places.len() {
            match runs.last_mut() {
                Some(run) if places[n] == places[n - 1] + 1 && run.len() < LONGEST_RUN => {
                    run.end += 1;
                }
                _ => runs.push(n..n + 1),
            }
        }
        let ring = precision.ring.transform_ring(precision.ring.zeros(), 1.0);
        let row = ring.answer(|k| precision.density[k].recip());
        let mut parts = BTreeMap::new();
        for run in &runs {
            let len = run.len();
            if let Entry::Vacant(part) = parts.entry(len)
                && let Some(made) = DMatrix::from_fn(len, len, |i, j| row[i.abs_diff(j)]).cholesky()
            {
                part.insert(made);
            }
        }
        Self { runs, parts }
    }

    fn solve(&self, wanted: &[f64]) -> Vec<f64> {
        let mut solved = wanted.to_vec();
        for run in &self.runs {
            // One that rounding makes indefinite is left as it is: any positive matrix will do.
            if let Some(part) = self.parts.get(&run.len()) {
                let mut values = DVector::from_column_slice(&wanted[run.clone()]);
                part.solve_mut(&mut values);
                solved[run.clone()].copy_from_slice(values.as_slice());
            }
        }
        solved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::{Gaussian, Seed};

    const LENGTH: usize = 1200;
    const RATE_HZ: f64 = 50.0;

    /// Red noise on a white floor.
    fn density() -> Vec<f64> {
        let of = |k: usize| 0.1 + 10.0 / (1.0 + (k as f64 / 40.0).powi(2));
        (0..=LENGTH / 2).map(of).collect()
    }

    /// Noise of the law, and the same with what is `missing` moved to where it is likeliest.
    fn filled(seed: u64, missing: &[Range<usize>]) -> (Vec<f64>, Vec<f64>) {
        let (density, ring) = (density(), Transformer::new(LENGTH));
        let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let noise = ring.noise(&density, RATE_HZ, || normal.draw());
        let unknown = Unknown::within(&density, missing);
        let mut lost = ring.series(&noise);
        missing.iter().for_each(|one| lost[one.clone()].fill(7.0));
        let mut filled = lost.to_vec();
        let moves = unknown.moves(&ring.transform_ring(lost, RATE_HZ));
        for (&place, by) in unknown.places().iter().zip(&moves) {
            filled[place] += by;
        }
        (noise.to_vec(), filled)
    }

    /// Covariance of the law at each distance, about a mean that is not known.
    fn covariance() -> Vec<f64> {
        let ring = Transformer::new(LENGTH);
        let zeros = ring.transform_ring(ring.zeros(), RATE_HZ);
        let density = density();
        let about_mean = zeros.answer(|k| density[k]).to_vec();
        let free = 1e6 * about_mean[0];
        about_mean.into_iter().map(|one| one + free).collect()
    }

    #[test]
    fn what_is_missing_is_as_its_neighbours_have_it() {
        // One run that is solved for in two parts, and two that overlap.
        let missing = [100..400, 700..705, 703..710];
        let (noise, filled) = filled(3, &missing);
        let places: Vec<usize> = (100..400).chain(700..710).collect();
        let there: Vec<usize> = (0..LENGTH).filter(|n| !places.contains(n)).collect();
        let covariance = covariance();
        let between = |a: &[usize], b: &[usize]| {
            DMatrix::from_fn(a.len(), b.len(), |i, j| covariance[a[i].abs_diff(b[j])])
        };
        let known = DVector::from_iterator(there.len(), there.iter().map(|&n| noise[n]));
        let weights = between(&there, &there)
            .cholesky()
            .expect("a positive matrix")
            .solve(&known);
        let expected = between(&places, &there) * weights;
        // A hundredth of a deviation is left by the last turn, several of them in a row.
        let deviation = (covariance[0] / 1e6).sqrt();
        for (n, &place) in places.iter().enumerate() {
            let off = (filled[place] - expected[n]).abs();
            assert!(off < 0.05 * deviation, "{place}: off by {off}, seed 3");
        }
    }

    #[test]
    fn what_is_there_stays() {
        let (noise, filled) = filled(4, &[100..130]);
        let there = (0..100).chain(130..LENGTH);
        assert!(there.into_iter().all(|n| noise[n] == filled[n]));
    }
}
