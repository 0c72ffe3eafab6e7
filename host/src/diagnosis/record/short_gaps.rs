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
//! (conditioning by kriging: J.-P. Chiles and P. Delfiner, *Geostatistics*, 2012, section 7.3.1). Drawn again and again from the
//! law that was fitted to what was drawn before, the two come to agree as the EM algorithm does
//! (A. P. Dempster, N. M. Laird and D. B. Rubin, J. R. Statist. Soc. B 39 (1977) 1), by the share that is
//! missing each time.

use std::ops::Range;

use crate::diagnosis::record::beyond::{self, Limit};
use crate::diagnosis::record::drawn::Drawn;
use crate::diagnosis::record::runs::runs_of;

/// Samples that were never there in the longest gap that is filled: a choice. A third missing at random makes none of half of
/// that, and a packet of a sensor's queue is rarely longer.
const LONGEST: usize = 32;

/// Share of a record that is filled at most: a choice. Beyond it the fill would outweigh what was measured.
const MOST: f64 = 0.5;

/// The short gaps of a record.
pub struct ShortGaps {
    /// Ascending and disjoint.
    gaps: Vec<Range<usize>>,
    /// All samples in them, ascending, and behind them those of the seam.
    places: Vec<usize>,
    missing: usize,
    share: f64,
    drawn: Drawn,
}

impl ShortGaps {
    /// Those of a record that was `measured` so, with NaN for what is missing. The samples at the places `replaced`,
    /// ascending, count as none: however many of these follow each other, they are not left as they are. `None` where
    /// there are no gaps, or too many to fill. What is missing at either end is no gap.
    pub fn of(measured: &[f64], replaced: &[usize]) -> Option<Self> {
        let len = measured.len();
        let is_replaced = |n: &usize| replaced.binary_search(n).is_ok();
        let mut gaps = runs_of(len, |n| !measured[n].is_finite() || is_replaced(&n));
        let never_there = |gap: &Range<usize>| gap.clone().filter(|n| !is_replaced(n)).count();
        gaps.retain(|gap| never_there(gap) <= LONGEST && gap.start > 0 && gap.end < len);
        let missing = gaps.iter().map(Range::len).sum();
        let is_there = |n: &usize| measured[*n].is_finite() && !is_replaced(n);
        let there = (0..len).filter(is_there).count();
        let share = missing as f64 / (missing + there) as f64;
        if missing == 0 || share > MOST {
            return None;
        }
        let drawn = Drawn::of(measured);
        let places = gaps.iter().cloned().chain(drawn.seam()).flatten().collect();
        Some(Self {
            gaps,
            places,
            missing,
            share,
            drawn,
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
        self.drawn.ring_len()
    }

    /// Fills them in `values`, which are filled somehow and miss nothing: with noise of the two-sided densities
    /// `density` at the ordinates of the ring, as it may be between the samples that are there and beyond `limits`, ascending.
    pub fn fill(&self, values: &mut [f64], limits: &[Limit], rate_hz: f64, density: &[f64]) {
        let mut off = self.drawn.off(values, rate_hz, density);
        self.drawn.close(&mut off);
        let moves = self.drawn.moves(off, &self.places, rate_hz, density);
        for (&place, by) in self.places().iter().zip(moves) {
            values[place] += by;
        }
        if !limits.is_empty() {
            beyond::draw(values, limits, rate_hz, density, &self.drawn);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::diagnosis::statistic::matched_filter::Transformer;
    use crate::model::Seed;
    use crate::model::random::Gaussian;

    const RATE_HZ: f64 = 50.0;

    fn of(values: &[f64]) -> Option<ShortGaps> {
        ShortGaps::of(values, &[])
    }

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
    fn a_tone_that_ends_in_another_phase_than_it_began_goes_on_in_gaps_next_to_the_ends() {
        const LEN: usize = 20_000;
        /// Turns of the tone in the record, and how far beside it its power lies.
        const TURNS: f64 = 500.5;
        const BESIDE: f64 = 40.0;
        for seed in 12..15 {
            let [mut noise, mut lost] =
                [3, 4].map(|stream| Gaussian::new(Seed { seed, stream }, 1.0));
            let tone = |n: usize| {
                let turns = TURNS * n as f64 / LEN as f64;
                1000.0 * (std::f64::consts::TAU * turns + 1.0).cos()
            };
            let truth: Vec<f64> = (0..LEN).map(|n| tone(n) + noise.draw()).collect();
            // A third of normal numbers is below this.
            let lose = |value: &f64| {
                if lost.draw() < -0.43 {
                    f64::NAN
                } else {
                    *value
                }
            };
            let mut values: Vec<f64> = truth.iter().map(lose).collect();
            // What is missing at either end is no gap.
            (values[0], values[LEN - 1]) = (truth[0], truth[LEN - 1]);
            let gaps = of(&values).expect("short gaps");
            let turns = |k: usize| k as f64 * LEN as f64 / gaps.ring_len() as f64;
            let in_band = 500_f64.powi(2) * LEN as f64 / RATE_HZ / (2.0 * BESIDE);
            let density = |k: usize| {
                let is_tone = (turns(k) - TURNS).abs() < BESIDE;
                RATE_HZ.recip() + if is_tone { in_band } else { 0.0 }
            };
            let density: Vec<f64> = (0..=gaps.ring_len() / 2).map(density).collect();
            gaps.bridge(&mut values);
            gaps.fill(&mut values, &[], RATE_HZ, &density);
            let near = gaps.places().iter().filter(|place| **place < 300);
            let off: Vec<f64> = near
                .map(|&place| (values[place] - truth[place]).powi(2))
                .collect();
            let off = (off.iter().sum::<f64>() / off.len() as f64).sqrt();
            // Three hundredths of the tone; with no more between the ends than a filter spreads it is up to a quarter.
            assert!(off < 30.0, "seed {seed}: {off}");
        }
    }

    #[test]
    fn what_a_sample_does_to_a_gap_is_what_the_law_says() {
        let seed = 11;
        let values = with_gaps(seed);
        let gaps = of(&values).expect("short gaps");
        let density = density(gaps.ring_len());
        let filled = |values: &[f64]| {
            let mut values = values.to_vec();
            gaps.bridge(&mut values);
            gaps.fill(&mut values, &[], RATE_HZ, &density);
            values
        };
        // What is drawn is the same in both: their difference is the conditional mean of the gaps, given a sample.
        let (moved, by) = (72 + 5, 1000.0);
        let mut other = values.clone();
        other[moved] += by;
        let pairs = filled(&other).into_iter().zip(filled(&values));
        let difference: Vec<f64> = pairs.map(|(other, one)| other - one).collect();
        let ring = Transformer::new(gaps.ring_len());
        let zeros = ring.transform_ring(ring.zeros(), RATE_HZ);
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
        let gaps = of(&values).expect("short gaps");
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
    fn what_is_no_measurement_is_filled_however_long() {
        let mut values = vec![1.0; 400];
        values[100..133].fill(f64::NAN);
        values[200..201].fill(f64::NAN);
        let replaced: Vec<usize> = (201..290).chain(300..340).collect();
        let gaps = ShortGaps::of(&values, &replaced).expect("gaps");
        assert_eq!(gaps.ranges(), [200..290, 300..340]);
        assert!((gaps.share() - 130.0 / (400.0 - 33.0)).abs() < 1e-12);
    }

    #[test]
    fn nothing_missing_and_too_much_missing_are_left_alone() {
        assert!(of(&[1.0; 100]).is_none());
        let every_third = (0..300).map(|n| if n % 3 == 1 { 1.0 } else { f64::NAN });
        assert!(of(&every_third.collect::<Vec<f64>>()).is_none());
    }
}
