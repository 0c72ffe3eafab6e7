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
use crate::diagnosis::record::drawn::{Drawn, Noise};
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

    /// Fills them in `values`, which are filled somehow and miss nothing: with `noise` as it may be between the samples
    /// that are there and beyond `limits`, ascending. Its strength moves slowly, next to what hangs together.
    pub fn fill(&self, values: &mut [f64], limits: &[Limit], noise: &Noise<'_>) {
        let mut off = self.drawn.off(values, noise);
        self.drawn.close(&mut off);
        let moves = self.drawn.moves(off, &self.places, noise);
        for (&place, by) in self.places().iter().zip(moves) {
            values[place] += by;
        }
        if !limits.is_empty() {
            beyond::draw(values, limits, noise, &self.drawn);
        }
    }
}

#[cfg(test)]
mod tests;
