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
use crate::diagnosis::statistic::matched_filter::smooth_len;
use crate::diagnosis::statistic::p_value;
use crate::fft::{self, long::Long};

/// Ordinates of the narrowest group, and how much wider the next ones are: choices. What lasts
/// between two lengths of tile is spread over two of the one, or half fills the other.
const NARROWEST: usize = 64;
const WIDER: usize = 4;

/// Ordinates of the widest band whose transform is planned: a choice, for a plan's tables are as
/// long. Wider ones are transformed in columns and rows.
const LONGEST: usize = 1 << 16;

/// Samples of the shortest tile: a choice, two blocks of the powers. What shorter events do is the
/// business of single samples.
const SHORTEST: usize = 128;

/// Tiles that a sum must have to be compared with its law: its skewness is then 0.11, little enough
/// for a gamma law to follow.
const LEAST_TILES: usize = 256;

/// Moments at which a tile is asked whether its samples count: a choice.
const ASKED: usize = 8;

/// Standard deviations from which a group next to an unsteady band belongs to it: a choice. Of
/// steady ones one in 160 does.
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

/// Strength of the whitened record in the band of the ordinates, at `ordinates.len()` moments, in
/// units of its density.
pub fn strengths(seen: &Whitened, ordinates: Range<usize>) -> Vec<f64> {
    over_time(seen, whitened(seen, ordinates).collect())
}

fn whitened(seen: &Whitened, ordinates: Range<usize>) -> impl Iterator<Item = Complex64> {
    let pairs = seen.transform.ordinates()[ordinates.clone()].iter();
    let pairs = pairs.zip(&seen.density[ordinates]);
    pairs.map(|(ordinate, density)| ordinate / density.sqrt())
}

fn over_time(seen: &Whitened, mut band: Vec<Complex64>) -> Vec<f64> {
    // A length with large prime factors would take many times the time and the memory.
    band.truncate(smooth_len(band.len()));
    if band.len() > LONGEST {
        Long::new(band.len()).inverse(&mut band);
    } else {
        fft::inverse(band.len()).process(&mut band);
    }
    let unit = (band.len() as f64 * seen.transform.power()).recip();
    band.iter().map(|value| value.norm_sqr() * unit).collect()
}

/// Power in a band over time, at even moments, over its mean: of the record as it is, whether or
/// not the band is excluded.
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

/// Which of `size` moments count: those most of whose samples are measured ones.
pub fn counting(axis: &AxisState, length: usize, size: usize) -> Vec<bool> {
    (0..size)
        .map(|moment| {
            // A moment stands in the middle of its samples.
            let good = (0..ASKED).filter(|part| {
                let at = moment as f64 - 0.5 + (*part as f64 + 0.5) / ASKED as f64;
                let sample = (at * length as f64 / size as f64).rem_euclid(length as f64);
                axis.usable(sample as usize)
            });
            good.count() == ASKED
        })
        .collect()
}

/// Sum of scores of the tiles that count, and their number.
fn score(strengths: &[f64], counts: &[bool]) -> (f64, f64) {
    let good = || {
        let pairs = strengths.iter().zip(counts);
        pairs.filter(|(_, counts)| **counts).map(|(one, _)| *one)
    };
    let tiles = good().count() as f64;
    let mean = good().sum::<f64>() / tiles.max(1.0);
    if tiles < 8.0 || mean <= 0.0 {
        return (0.0, 0.0);
    }
    // Over the group's own mean, which takes 1/8 a group off.
    let sum: f64 = good().map(|one| (-one / mean).exp() - 0.5).sum();
    (sum + 0.125, tiles)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::sync::Arc;

    use super::*;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    const LENGTH: usize = 1 << 17;
    const RATE_HZ: f64 = 2000.0;

    /// White noise of deviation 1 with what `more` adds, of a sample's number and noise.
    fn axis(seed: u64, more: impl Fn(usize, f64) -> f64) -> AxisState {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let values = (0..LENGTH).map(|n| more(n, noise.draw())).collect();
        AxisState::new(Arc::new(values), RATE_HZ, None).expect("long enough")
    }

    /// A tone of this amplitude that sways by 20 Hz about 300 Hz, six times a record.
    fn wandering(amplitude: f64) -> impl Fn(usize, f64) -> f64 {
        move |n, noise| {
            let at = n as f64 / LENGTH as f64;
            // The integral of 300 + 20 cos(2 pi 6 at).
            let swings = 20.0 * (TAU * 6.0 * at).sin() / (TAU * 6.0);
            let cycles = (300.0 * at + swings) * LENGTH as f64 / RATE_HZ;
            noise + amplitude * (TAU * cycles).cos()
        }
    }

    #[test]
    fn steady_noise_is_steady() {
        // 40 records at a level of 1 %: four or more alarms have a probability of 1e-3.
        let alarms = (0..40).filter(|&seed| {
            let axis = axis(seed, |_, noise| noise);
            unsteady(&axis, 0.0..1000.0, &[], 0.01).is_some()
        });
        let alarms: Vec<u64> = alarms.collect();
        assert!(alarms.len() < 4, "seeds {alarms:?}");
    }

    #[test]
    fn a_wandering_tone_is_found_in_its_place() {
        for seed in 100..104 {
            let found = unsteady(&axis(seed, wandering(0.5)), 0.0..1000.0, &[], 1e-4);
            let found = found.unwrap_or_else(|| panic!("seed {seed}: nothing"));
            // Groups of 15.6 Hz at most lie across its ends.
            assert!(
                found.from_hz > 260.0 && found.to_hz < 340.0,
                "seed {seed}: {found:?}"
            );
        }
    }

    #[test]
    fn noise_that_is_switched_is_unsteady_everywhere() {
        for seed in 200..204 {
            let switched = |n: usize, noise: f64| if n % 4000 < 2000 { noise } else { 1.4 * noise };
            let found = unsteady(&axis(seed, switched), 0.0..1000.0, &[], 1e-4);
            let found = found.unwrap_or_else(|| panic!("seed {seed}: nothing"));
            assert!(
                found.to_hz - found.from_hz > 500.0,
                "seed {seed}: {found:?}"
            );
            // Powers of 1 and 1.96 by turns: relative variance 0.105.
            assert!(
                (0.05..0.2).contains(&found.variance),
                "seed {seed}: {found:?}"
            );
        }
    }

    #[test]
    fn what_is_apart_is_not_looked_at() {
        let axis = axis(300, wandering(0.5));
        let found = unsteady(&axis, 0.0..1000.0, &[250.0..350.0], 1e-4);
        assert_eq!(found, None, "seed 300");
    }
}
