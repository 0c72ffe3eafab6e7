//! Allan variance from the means of incomplete blocks, for averaging times that no run of samples
//! without a gap is long enough for.
//!
//! The record is cut into blocks of `m` samples at multiples of `m`. A block counts when at least
//! 90 % of its samples are there; neighbouring blocks that count give one difference of means each,
//! without overlap (Pavlov and Petrov eq. 4).
//!
//! # Bias
//!
//! A mean of a fraction `f` of a block stands for the whole one. For white noise the variance comes
//! out as the mean of `1/f`, at most 1.11 times too large; [`BlockEstimate::white_bias`] is that
//! factor for the blocks at hand. Flicker and walk noise vary mostly between blocks and are biased
//! by less. Differenced white noise no longer cancels at the edges of gaps: there the estimate is
//! too large by about the number of runs in a block, and is not to be used.

mod octave;

use crate::engine::LAST_INDEX;
use crate::fixed_point::CODE_LIMIT;
use crate::statistic::{Estimate, Statistic};
use octave::{Block, FRACTION_BITS, Octave};

/// Shortest block, in samples.
const SHORTEST: u64 = 64;

/// Allan variance from block means, to be marked as such.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockEstimate {
    /// The estimate; its stride is `m`.
    pub estimate: Estimate,
    /// How many times too large it comes out for white noise, 1 to 1.11.
    pub white_bias: f64,
}

/// Streaming Allan variance from block means, at `m` = 64 * 2^k samples for `k` below `OCTAVES`.
#[derive(Debug, Clone)]
pub struct BlockMeans<const OCTAVES: usize> {
    first: u64,
    next: u64,
    octaves: [Octave; OCTAVES],
    /// The shortest block under way.
    current: Block,
}

impl<const OCTAVES: usize> BlockMeans<OCTAVES> {
    /// Empty, the first sample having absolute index `first`. `OCTAVES` is at most 57.
    #[must_use]
    pub const fn starting_at(first: u64) -> Self {
        const { assert!(OCTAVES <= 57, "a block must fit the index") };
        Self {
            first,
            next: first,
            octaves: [Octave::EMPTY; OCTAVES],
            current: Block::EMPTY,
        }
    }

    /// Accepts a run of codes.
    pub fn push_slice(&mut self, codes: &[i32]) {
        self.push_run(codes, |&code| i64::from(code));
    }

    /// Accepts a run of [`fixed_point`](crate::fixed_point) codes; a larger one than those is
    /// taken as the largest.
    pub fn push_wide(&mut self, codes: &[i64]) {
        self.push_run(codes, |&code| code.clamp(-CODE_LIMIT, CODE_LIMIT));
    }

    fn push_run<T>(&mut self, mut run: &[T], code: impl Fn(&T) -> i64) {
        while !run.is_empty() {
            let room = (SHORTEST - self.next % SHORTEST) as usize;
            let (now, rest) = run.split_at(room.min(run.len()));
            // At most 64 codes of 43 bits.
            let sum: i64 = now.iter().map(&code).sum();
            self.current.sum += i128::from(sum);
            self.current.samples += now.len() as u64;
            self.pass(now.len() as u64);
            run = rest;
        }
    }

    /// Begins anew after a gap of unknown length: what follows is not paired with what was.
    /// Differences that are complete stand. The next sample has index 0.
    pub fn restart(&mut self) {
        for octave in &mut self.octaves {
            octave.half = Block::EMPTY;
            octave.previous = None;
        }
        self.current = Block::EMPTY;
        (self.first, self.next) = (0, 0);
    }

    /// Passes over `missing` samples: a gap.
    pub fn skip(&mut self, missing: u64) {
        let mut missing = missing.min(LAST_INDEX.saturating_sub(self.next));
        while missing > 0 {
            let room = SHORTEST - self.next % SHORTEST;
            // A gap of whole longest blocks leaves nothing that could still be paired or filled.
            let longest = SHORTEST << OCTAVES;
            if missing > 4 * longest && self.next.is_multiple_of(longest) {
                let whole = (missing / longest - 2) * longest;
                self.octaves
                    .iter_mut()
                    .for_each(|octave| octave.previous = None);
                self.next += whole;
                missing -= whole;
                continue;
            }
            let now = room.min(missing);
            self.pass(now);
            missing -= now;
        }
    }

    /// Moves on by at most the rest of the shortest block, and closes the blocks that end there.
    fn pass(&mut self, samples: u64) {
        self.next += samples;
        if !self.next.is_multiple_of(SHORTEST) {
            return;
        }
        let mut block = core::mem::replace(&mut self.current, Block::EMPTY);
        for (octave, k) in self.octaves.iter_mut().zip(0..) {
            let m = SHORTEST << k;
            octave.push(m, block);
            if !self.next.is_multiple_of(2 * m) {
                octave.half = block;
                return;
            }
            // Both halves are over; the first may lie before the record and then is empty.
            let half = core::mem::replace(&mut octave.half, Block::EMPTY);
            block = Block {
                sum: half.sum + block.sum,
                samples: half.samples + block.samples,
            };
        }
    }

    /// Absolute index of the first sample.
    #[must_use]
    pub fn first_index(&self) -> u64 {
        self.first
    }

    /// The estimates at every averaging time that has a difference, shortest first.
    pub fn points(&self) -> impl Iterator<Item = BlockEstimate> + '_ {
        let octaves = self
            .octaves
            .iter()
            .zip(0..)
            .filter(|(octave, _)| octave.terms > 0);
        octaves.map(|(octave, k)| {
            let m = SHORTEST << k;
            // Differences of means, where the other estimates have differences of sums.
            let unit = 1.0 / (1_u64 << FRACTION_BITS) as f64;
            let variance =
                Statistic::Allan.variance(1, octave.terms, &octave.squares) * unit * unit;
            BlockEstimate {
                estimate: Estimate {
                    m,
                    variance,
                    terms: octave.terms,
                    stride: m,
                },
                white_bias: octave.inverse_fractions / octave.terms as f64,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::full;
    use std::vec::Vec;

    fn noise(len: usize) -> Vec<i32> {
        let mut state = 99_u64;
        (0..len)
            .map(|_| {
                let mut sum = 0;
                for _ in 0..8 {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1);
                    sum += (state >> 48) as i32;
                }
                sum
            })
            .collect()
    }

    #[test]
    fn without_gaps_it_is_the_plain_estimate() {
        let codes = noise(64 * 40);
        let mut means = BlockMeans::<4>::starting_at(0);
        codes.chunks(37).for_each(|chunk| means.push_slice(chunk));
        let points: Vec<_> = means.points().collect();
        assert_eq!(points.len(), 4);
        for point in points {
            let m = point.estimate.m as usize;
            let pairs = 40 * 64 / m - 1;
            let mean: f64 = (0..pairs)
                .map(|i| {
                    let pair = &codes[i * m..(i + 2) * m];
                    full::integers(Statistic::Allan, &[pair], m as u64)
                        .unwrap()
                        .variance
                })
                .sum::<f64>()
                / pairs as f64;
            assert_eq!(
                (point.estimate.terms, point.white_bias),
                (pairs as u64, 1.0)
            );
            assert!((point.estimate.variance / mean - 1.0).abs() < 1e-6, "m={m}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "statistics over four million samples")]
    fn gaps_of_a_tenth_give_the_truth_times_the_stated_bias() {
        // White noise with a large mean, the last 10 % of every 1000 samples missing (in runs of
        // 100): no whole difference beyond m = 450.
        let codes = noise(4_000_000);
        let mut means = BlockMeans::<12>::starting_at(0);
        for thousand in codes.chunks(1000) {
            means.push_slice(&thousand[..900]);
            means.skip(100);
        }
        // Eight uniform deviates on 2^16 levels.
        let sample_variance = 8.0 * (2.0_f64.powi(32) - 1.0) / 12.0;
        let mut tested = 0;
        for BlockEstimate {
            estimate,
            white_bias,
        } in means.points().filter(|p| p.estimate.m > 450)
        {
            let expected = sample_variance / estimate.m as f64 * white_bias;
            // Adjacent non-overlapping differences of white noise: edf is 2/3 of their number.
            let tolerance = 4.0 * (3.0 / estimate.terms as f64).sqrt();
            let relative = estimate.variance / expected - 1.0;
            assert!((1.0..=1.112).contains(&white_bias), "{white_bias}");
            assert!(
                relative.abs() < tolerance,
                "m={}: {relative}, seed 99",
                estimate.m
            );
            tested += 1;
        }
        assert!(tested >= 6, "{tested}");
    }

    #[test]
    fn a_gap_of_unknown_length_separates() {
        let codes = noise(64 * 8);
        let mut means = BlockMeans::<3>::starting_at(64);
        means.push_slice(&codes);
        means.restart();
        let wide: Vec<i64> = codes.iter().map(|&code| i64::from(code)).collect();
        means.push_wide(&wide);
        let terms: Vec<_> = means.points().map(|point| point.estimate.terms).collect();
        // From 64 on, an octave's first block is incomplete.
        assert_eq!(terms, [7 + 7, 2 + 3, 1]);
    }

    #[test]
    fn a_long_gap_separates_and_takes_no_time() {
        let codes = noise(64 * 8);
        let mut means = BlockMeans::<3>::starting_at(0);
        means.push_slice(&codes);
        means.skip(1 << 60);
        means.push_slice(&codes);
        let terms: Vec<_> = means.points().map(|point| point.estimate.terms).collect();
        assert_eq!(terms, [2 * 7, 2 * 3, 2]);
    }
}
