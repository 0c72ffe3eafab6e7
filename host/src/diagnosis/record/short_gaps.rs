//! Short gaps, filled with noise as the rest of the record has it.
//!
//! A sample lost here and there, or a third of all at random, leaves no stretch that is whole. Straight lines
//! in their places are no noise: where neighbours differ by much (quantisation noise) or hang together over
//! long (walk behind a filter), each of them leaves a mark that looks like an event. So the places `M` that
//! are missing are drawn from what the fitted law `S(f)` says of them, given all samples that are there. With
//! a record `z` drawn from that law and `P`, the circulant matrix with the spectrum `1 / S`, the fill is `x_M` of
//!
//! ```text
//! [P (x - z)]_M = 0,    x as measured elsewhere
//! ```
//!
//! (conditioning by kriging: J.-P. Chiles and P. Delfiner, *Geostatistics*, 2012, section 7.3.1), solved by
//! conjugate gradients (M. R. Hestenes and E. Stiefel, J. Res. NBS 49 (1952) 409). Drawn again and again from the
//! law that was fitted to what was drawn before, the two come to agree as the EM algorithm does
//! (A. P. Dempster, N. M. Laird and D. B. Rubin, J. R. Statist. Soc. B 39 (1977) 1), by the share that is
//! missing each time.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::diagnosis::record::runs::runs_of;
use crate::diagnosis::statistic::matched_filter::{Transform, Transformer, smooth_len_from};
use crate::model::Seed;
use crate::model::random::Gaussian;

/// Samples of the longest gap that is filled: a choice. A third missing at random makes none of half of that,
/// and a packet of a sensor's queue is rarely longer.
const LONGEST: usize = 32;

/// Share of a record that is filled at most: a choice. Beyond it the fill would outweigh what was measured.
const MOST: f64 = 0.5;

/// Turns of the solution at most: no gap of [`LONGEST`] samples needs more, but many different ones may.
const TURNS: usize = 64;

/// What the last turn may gain, as a part of a degree of freedom for each sample that is filled: a choice. A sample
/// then moves by some three thousandths of what it is not known by, the root of it.
const LAST: f64 = 1e-5;

/// Any seed is as good as another; the same one each time, so that a record has one answer.
const SEED: Seed = Seed { seed: 1, stream: 0 };

/// Samples behind the end of the record and ahead of its begin that no one knows, where it is closed into a ring: a
/// choice, as far as the converter's filter spreads a sample.
const SEAM: usize = 64;

/// The short gaps of a record.
pub struct ShortGaps {
    /// Ascending and disjoint.
    gaps: Vec<Range<usize>>,
    /// All samples in them, ascending, and behind them those of the seam.
    places: Vec<usize>,
    missing: usize,
    share: f64,
    ring: Transformer,
}

impl ShortGaps {
    /// Those of `measured`, where missing samples are NaN. `None` where there are none, or too many to fill.
    /// What is missing at either end is no gap.
    pub fn of(measured: &[f64]) -> Option<Self> {
        let mut gaps = runs_of(measured.len(), |n| !measured[n].is_finite());
        gaps.retain(|gap| gap.len() <= LONGEST && gap.start > 0 && gap.end < measured.len());
        let missing = gaps.iter().map(Range::len).sum();
        let there = measured.iter().filter(|value| value.is_finite()).count();
        let share = missing as f64 / (missing + there) as f64;
        if missing == 0 || share > MOST {
            return None;
        }
        let ring = Transformer::new(smooth_len_from(measured.len() + SEAM));
        let (end, len) = (measured.len(), ring.len());
        let seam = [end..end + SEAM, (len - SEAM).max(end + SEAM)..len];
        let places = gaps.iter().cloned().chain(seam).flatten().collect();
        Some(Self {
            gaps,
            places,
            missing,
            share,
            ring,
        })
    }

    /// Share of the samples that are filled, of those that are there or filled.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// All gaps, ascending and disjoint.
    pub fn ranges(&self) -> &[Range<usize>] {
        &self.gaps
    }

    /// Places of all samples that are filled, ascending.
    pub fn places(&self) -> &[usize] {
        &self.places[..self.missing]
    }

    /// A first fill: straight lines between neighbours.
    pub fn bridge(&self, values: &mut [f64]) {
        for gap in &self.gaps {
            let (from, to) = (values[gap.start - 1], values[gap.end]);
            let step = (to - from) / (gap.len() + 1) as f64;
            for (n, value) in values[gap.clone()].iter_mut().enumerate() {
                *value = from + step * (n + 1) as f64;
            }
        }
    }

    /// Samples of the ring at whose ordinates densities are wanted.
    pub fn ring_len(&self) -> usize {
        self.ring.len()
    }

    /// Fills them in `values`, which are filled somehow and miss nothing: with noise of the two-sided densities
    /// `density` at the ordinates of the ring, as it may be between the samples that are there.
    pub fn fill(&self, values: &mut [f64], rate_hz: f64, density: &[f64]) {
        let mut normal = Gaussian::new(SEED, 1.0);
        let noise = self.ring.noise(density, rate_hz, || normal.draw());
        let mut off = self.ring.padded(values);
        let pairs = off.iter_mut().zip(noise.iter());
        pairs
            .take(values.len())
            .for_each(|(off, noise)| *off -= noise);
        close(&mut off, values.len());
        let precision = Precision {
            ring: &self.ring,
            places: &self.places,
            rate_hz,
            density,
        };
        let off = self.ring.transform_ring(off, rate_hz);
        let wanted = precision.at_places(&off).into_iter().map(|one| -one);
        let moves = precision.solve(wanted.collect());
        for (&place, by) in self.places().iter().zip(moves) {
            values[place] += by;
        }
    }
}

/// Closes what begins with a record of `len` samples by a straight line from the mean of its end to that of its begin.
fn close(ring: &mut [f64], len: usize) {
    let end = SEAM.min(len / 2).max(1);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let (to, from) = (mean(&ring[..end]), mean(&ring[len - end..len]));
    let step = (to - from) / (ring.len() - len + 1) as f64;
    for (n, value) in ring[len..].iter_mut().enumerate() {
        *value = from + step * (n + 1) as f64;
    }
}

/// The matrix `P` at the places that are missing.
struct Precision<'a> {
    ring: &'a Transformer,
    places: &'a [usize],
    rate_hz: f64,
    density: &'a [f64],
}

impl Precision<'_> {
    /// `P` times a record, there.
    fn at_places(&self, record: &Transform) -> Vec<f64> {
        let whole = record.filtered(|k| self.density[k].recip().into());
        self.places.iter().map(|&place| whole[place]).collect()
    }

    /// `P` times what is zero elsewhere, there.
    fn times(&self, values: &[f64]) -> Vec<f64> {
        let mut series = self.ring.zeros();
        for (&place, value) in self.places.iter().zip(values) {
            series[place] = *value;
        }
        self.at_places(&self.ring.transform_ring(series, self.rate_hz))
    }

    /// What `P` turns into `wanted`.
    fn solve(&self, wanted: Vec<f64>) -> Vec<f64> {
        let runs = Runs::new(self);
        let mut found = vec![0.0; wanted.len()];
        let mut left = wanted;
        let mut towards = runs.solve(&left);
        let mut square = dot(&left, &towards);
        for _ in 0..TURNS {
            let turned = self.times(&towards);
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
            if gain <= LAST * self.rate_hz * found.len() as f64 {
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
    fn new(precision: &Precision<'_>) -> Self {
        let places = precision.places;
        let mut runs: Vec<Range<usize>> = Vec::new();
        for n in 0..places.len() {
            match runs.last_mut() {
                Some(run) if places[n] == places[n - 1] + 1 && run.len() < SEAM => run.end += 1,
                _ => runs.push(n..n + 1),
            }
        }
        let ring = precision
            .ring
            .transform_ring(precision.ring.zeros(), precision.rate_hz);
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

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 50.0;

    /// Noise with gaps of one to five samples.
    fn with_gaps(seed: u64) -> Vec<f64> {
        let mut normal = Gaussian::new(Seed { seed, stream: 3 }, 1.0);
        let mut values: Vec<f64> = (0..150).map(|_| normal.draw()).collect();
        for gap in [20..21, 23..24, 70..75, 90..92] {
            values[gap].fill(f64::NAN);
        }
        values
    }

    /// Red noise on a white floor.
    fn density(ring_len: usize) -> Vec<f64> {
        let of = |k: usize| 0.1 + 10.0 / (1.0 + (k as f64 / 4.0).powi(2));
        (0..=ring_len / 2).map(of).collect()
    }

    #[test]
    fn what_a_sample_does_to_a_gap_is_what_the_law_says() {
        let seed = 11;
        let values = with_gaps(seed);
        let gaps = ShortGaps::of(&values).expect("short gaps");
        let density = density(gaps.ring.len());
        let filled = |values: &[f64]| {
            let mut values = values.to_vec();
            gaps.bridge(&mut values);
            gaps.fill(&mut values, RATE_HZ, &density);
            values
        };
        // What is drawn is the same in both: their difference is the conditional mean of the gaps, given a sample.
        let (moved, by) = (72 + 5, 1000.0);
        let mut other = values.clone();
        other[moved] += by;
        let pairs = filled(&other).into_iter().zip(filled(&values));
        let difference: Vec<f64> = pairs.map(|(other, one)| other - one).collect();
        let zeros = gaps.ring.transform_ring(gaps.ring.zeros(), RATE_HZ);
        let row = zeros.answer(|k| density[k].recip());
        let places = &gaps.places;
        let inner = DMatrix::from_fn(places.len(), places.len(), |i, j| {
            row[places[i].abs_diff(places[j])]
        });
        let outer = DVector::from_fn(places.len(), |i, _| -by * row[places[i].abs_diff(moved)]);
        let expected = inner.lu().solve(&outer).expect("a positive matrix");
        for (n, &place) in gaps.places().iter().enumerate() {
            // A hundredth of a deviation, which is below 1 here, is left by the last turn; so far is that of either.
            let off = (difference[place] - expected[n]).abs();
            assert!(off < 0.02, "{place}: off by {off}, seed {seed}");
        }
        let largest = expected
            .iter()
            .fold(0.0_f64, |most, one| most.max(one.abs()));
        // A fiftieth of the sample by which it moved.
        assert!(largest > 20.0, "the neighbours follow by {largest}");
    }

    #[test]
    fn what_is_measured_stays_and_long_gaps_too() {
        let mut values = with_gaps(12);
        values[100..133].fill(f64::NAN);
        values[..3].fill(f64::NAN);
        let gaps = ShortGaps::of(&values).expect("short gaps");
        assert_eq!(gaps.ranges(), [20..21, 23..24, 70..75, 90..92]);
        assert_eq!(gaps.places().len(), 9);
        assert!((gaps.share() - 9.0 / (150.0 - 36.0)).abs() < 1e-12);
        let mut filled = values.clone();
        gaps.bridge(&mut filled);
        assert!(gaps.places().iter().all(|&place| filled[place].is_finite()));
        let measured = (0..150).filter(|n| values[*n].is_finite());
        assert!(measured.into_iter().all(|n| filled[n] == values[n]));
        assert!(filled[100..133].iter().all(|value| value.is_nan()));
    }

    #[test]
    fn nothing_missing_and_too_much_missing_are_left_alone() {
        assert!(ShortGaps::of(&[1.0; 100]).is_none());
        let every_third = (0..300).map(|n| if n % 3 == 1 { 1.0 } else { f64::NAN });
        assert!(ShortGaps::of(&every_third.collect::<Vec<f64>>()).is_none());
    }
}
