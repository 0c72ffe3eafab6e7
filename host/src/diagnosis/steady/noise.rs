//! Whether noise keeps its strength: the whitened record in tiles of time and frequency.
//!
//! The ordinates of a steady Gaussian record over the root of its density are independent complex
//! normal numbers. A group of `M` neighbours, transformed back by itself, is the record in a narrow
//! band at `M` moments, again independent; the power `E` of each, over the mean of its group, follows
//! the exponential law. Tones that wander or are switched, noise whose strength or colour changes,
//! and shocks that ring all make some tiles stronger and others weaker than that, or, where a tone
//! fills its band all the time, more alike.
//!
//! Each tile is scored by `s = e^-E - 1/2 + (E - 1) / 4`, which has mean 0, variance 1/48 and skewness
//! `sqrt 3` under the exponential law (its moments are `E[E^j e^-kE] = j! / (1 + k)^(j+1)`), and
//! for a strength of relative variance `v` the mean `v / 8`. Unlike the spectral kurtosis (J. Dwyer,
//! Proc. IEEE ICASSP 1983; G. M. Nita and D. E. Gary, PASP 122 (2010)) it is bounded below the
//! largest tiles' reach, so that single events do not decide. Sums over bands of all widths and
//! tiles of several shapes are compared with a gamma law of the same three moments.

use std::ops::Range;

use rayon::prelude::*;
use realfft::num_complex::Complex64;

use crate::diagnosis::axis::{AxisState, Whitened};
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::steady::tiles::{counting, known, over, over_time, score, whitened};
use crate::fft;

/// Ordinates of the narrowest group, and how much wider the next ones are: choices. What lasts
/// between two lengths of tile is spread over two of the one, or half fills the other.
const NARROWEST: usize = 64;
const WIDER: usize = 4;

/// Samples of the shortest tile: what shorter events do is the business of single samples.
const SHORTEST: usize = 128;

/// Tiles that a sum must have to be compared with its law: its skewness is then 0.11, little enough
/// for a gamma law to follow.
const LEAST_TILES: usize = 256;

/// Standard deviations from which a group beside an unsteady band belongs to it.
const SKIRT: f64 = 2.5;

/// Trials that free ends make of each trial of a band: a choice.
const FREE_ENDS: f64 = 16.0;

/// A band in which noise is not as steady as noise is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unsteady {
    /// Lower end of the band, hertz.
    pub from_hz: f64,
    /// Upper end of the band, hertz.
    pub to_hz: f64,
    /// Where it is plainest, hertz.
    pub peak_hz: f64,
    /// Duration of the tiles that show it best, seconds.
    pub tile_s: f64,
    /// Variance of the strength over its squared mean; negative where it is steadier than noise.
    pub variance: f64,
    /// Probability of as much in any band of steady noise.
    pub p_value: f64,
}

/// Power in a band over time, at even moments, over its mean: of the record as it is, whether or not the band is left out.
pub fn course(axis: &AxisState, band: &Range<f64>) -> Vec<f64> {
    let seen = axis.whitened();
    let place = |f_hz: f64| (f_hz / seen.transform.frequency(1)) as usize;
    let last = seen.transform.ordinates().len();
    let ordinates = place(band.start).max(1)..(place(band.end) + 1).min(last);
    let powers = over_time(&seen, seen.transform.ordinates()[ordinates].to_vec());
    let mean = powers.iter().sum::<f64>() / powers.len().max(1) as f64;
    powers.iter().map(|power| power / mean).collect()
}

/// The least steady band between the frequencies `within`, leaving out those of `excluded_hz`, if it is
/// significant at a family-wise `level`.
pub fn unsteady(
    axis: &AxisState,
    within: Range<f64>,
    excluded_hz: &[Range<f64>],
    level: f64,
) -> Option<Unsteady> {
    let seen = axis.whitened();
    let length = seen.transform.len();
    let mut best: Option<Best> = None;
    let mut trials = 0.0;
    let sizes = std::iter::successors(Some(NARROWEST), |size| Some(size * WIDER));
    let sizes: Vec<usize> = sizes.take_while(|size| size * SHORTEST <= length).collect();
    let groups = sizes.into_par_iter();
    let groups = groups.map(|size| Groups::new(axis, &seen, size, &within, excluded_hz));
    for groups in groups.collect::<Vec<Groups>>() {
        trials += groups.search(&mut best);
    }
    let best = best?;
    let p_value = p_value::searched(best.tail, FREE_ENDS * trials);
    (p_value < level).then(|| Unsteady {
        from_hz: seen.transform.frequency(best.ordinates.start),
        to_hz: seen.transform.frequency(best.ordinates.end),
        peak_hz: seen.transform.frequency(best.peak + best.size / 2),
        tile_s: length as f64 / best.size as f64 / axis.rate_hz,
        variance: 8.0 * best.mean,
        p_value,
    })
}

/// The band that departs most so far.
struct Best {
    ordinates: Range<usize>,
    /// First ordinate of the group that departs most.
    peak: usize,
    size: usize,
    mean: f64,
    tail: f64,
}

/// Sums of the tiles' scores, group by group of `size` ordinates.
struct Groups {
    size: usize,
    /// First ordinate of each group.
    starts: Vec<usize>,
    /// Sums of scores, and tiles, up to each.
    scores: Vec<f64>,
    tiles: Vec<f64>,
}

impl Groups {
    fn new(
        axis: &AxisState,
        seen: &Whitened,
        size: usize,
        within: &Range<f64>,
        excluded_hz: &[Range<f64>],
    ) -> Self {
        let counts = counting(axis, seen.transform.len(), size);
        let known = known(axis, seen.transform.len(), size);
        // One plan and one memory for thousands of groups, else as `strengths`.
        let plan = fft::inverse(size);
        let mut scratch = vec![Complex64::ZERO; plan.get_inplace_scratch_len()];
        let mut band = Vec::with_capacity(size);
        let mut strengths = Vec::with_capacity(size);
        let unit = (size as f64 * seen.transform.power()).recip();
        let mut groups = Self {
            size,
            starts: Vec::new(),
            scores: vec![0.0],
            tiles: vec![0.0],
        };
        let last = seen.top;
        let first = (within.start / seen.transform.frequency(1)).ceil() as usize;
        let mut start = first.max(NARROWEST);
        while start + size < last && seen.transform.frequency(start + size) <= within.end {
            let (low, high) = (
                seen.transform.frequency(start),
                seen.transform.frequency(start + size),
            );
            let is_apart = excluded_hz
                .iter()
                .any(|one| one.start < high && low < one.end);
            if !is_apart {
                band.clear();
                band.extend(whitened(seen, start..start + size));
                plan.process_with_scratch(&mut band, &mut scratch);
                strengths.clear();
                strengths.extend(band.iter().map(|value| value.norm_sqr() * unit));
                over(axis, &mut strengths, &known, &(start..start + size));
                let (score, tiles) = score(&strengths, &counts);
                groups.starts.push(start);
                groups
                    .scores
                    .push(groups.scores[groups.scores.len() - 1] + score);
                groups
                    .tiles
                    .push(groups.tiles[groups.tiles.len() - 1] + tiles);
            }
            start += size;
        }
        groups
    }

    /// Mean score of a run of groups, and the probability of as much either way.
    fn judge(&self, run: &Range<usize>) -> (f64, f64) {
        let tiles = self.tiles[run.end] - self.tiles[run.start];
        if tiles < LEAST_TILES as f64 {
            return (0.0, 1.0);
        }
        let mean = (self.scores[run.end] - self.scores[run.start]) / tiles;
        // Gamma of the skewness sqrt(3 / tiles): shape 4 tiles / 3.
        let shape = 4.0 * tiles / 3.0;
        let z = mean * (48.0 * tiles).sqrt();
        (
            mean,
            p_value::mean_square(1.0 + z / shape.sqrt(), 2.0 * shape),
        )
    }

    /// Looks through all runs of 1, 2, 4 ... groups; how many there were.
    fn search(&self, best: &mut Option<Best>) -> f64 {
        let groups = self.starts.len();
        let mut trials = 0.0;
        let mut length = 1;
        while length <= groups {
            for from in (0..=groups - length).step_by((length / 2).max(1)) {
                trials += 1.0;
                let run = from..from + length;
                let (_, tail) = self.judge(&run);
                if tail < best.as_ref().map_or(1.0, |best| best.tail) {
                    let run = self.ends(run);
                    let (mean, tail) = self.judge(&run);
                    let wide = self.skirts(run.clone());
                    *best = Some(Best {
                        ordinates: self.starts[wide.start]..self.starts[wide.end - 1] + self.size,
                        peak: self.peak(run, mean),
                        size: self.size,
                        mean,
                        tail,
                    });
                }
            }
            length *= 2;
        }
        trials
    }

    /// First ordinate of the group of a run that departs most in the direction of `mean`.
    fn peak(&self, run: Range<usize>, mean: f64) -> usize {
        let score = |group: usize| (self.scores[group + 1] - self.scores[group]) * mean.signum();
        let most = run.max_by(|&a, &b| score(a).total_cmp(&score(b)));
        most.map_or(0, |group| self.starts[group])
    }

    /// A run with the groups next to it that depart by themselves, the same way.
    fn skirts(&self, mut run: Range<usize>) -> Range<usize> {
        let (mean, _) = self.judge(&run);
        let departs = |group: usize| {
            let tiles = self.tiles[group + 1] - self.tiles[group];
            let sum = self.scores[group + 1] - self.scores[group];
            sum * mean.signum() > SKIRT * (tiles / 48.0).sqrt()
        };
        while run.start > 0 && departs(run.start - 1) {
            run.start -= 1;
        }
        while run.end < self.starts.len() && departs(run.end) {
            run.end += 1;
        }
        run
    }

    /// Moves both ends of a run to where it is least likely.
    fn ends(&self, mut run: Range<usize>) -> Range<usize> {
        let strength = |run: &Range<usize>| {
            let (mean, _) = self.judge(run);
            mean.abs() * (self.tiles[run.end] - self.tiles[run.start]).sqrt()
        };
        let reach = run.len();
        for _ in 0..4 {
            let before = run.clone();
            run.start = (run.start.saturating_sub(reach)..run.end)
                .max_by(|&a, &b| strength(&(a..run.end)).total_cmp(&strength(&(b..run.end))))
                .unwrap_or(run.start);
            run.end = (run.start + 1..=(run.end + reach).min(self.starts.len()))
                .max_by(|&a, &b| strength(&(run.start..a)).total_cmp(&strength(&(run.start..b))))
                .unwrap_or(run.end);
            if run == before {
                break;
            }
        }
        run
    }
}

#[cfg(test)]
mod tests;
