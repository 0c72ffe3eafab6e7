//! The floor under slow lines: below what averaged segments resolve, from the record's own ordinates.
//!
//! Sums over blocks keep the low frequencies; each sample is shared between the two nearest, by its
//! distance, so that what folds back is 50 dB and more below (noise that rises with the frequency
//! would fill the band otherwise). The median of an ordinate's neighbours, an eighth of
//! its number and more to either side, is the floor. With `n` of them, `r = (n + 1) / 2`, the power
//! `X` of noise over that median `m` exceeds `z` with probability
//!
//! ```text
//! P(X ln 2 / m > z) = E e^(-z m / ln 2) = prod_(i < r) (n - i) / (n - i + z / ln 2)
//! ```
//!
//! exactly for independent exponentials: the median is a sum of `r` independent gaps (A. Rényi,
//! Acta Math. Hung. 4 (1953)).

use std::f64::consts::{LN_2, PI};

use rustfft::{FftPlanner, num_complex::Complex64};

use crate::numeric::order::median;

/// Cycles a record of the slowest line that is searched: below, neighbours are few.
pub(super) const LOWEST: usize = 64;

/// Neighbours to either side, as a share of the ordinate's number.
const SPAN: f64 = 0.25;

/// Blocks for each ordinate: the sums then pass all but 1.3 % of the power, which is put back.
const BLOCKS_EACH: usize = 16;

/// Blocks at most.
const MOST_BLOCKS: usize = 1 << 20;

/// Sums over blocks of a record, on their way to a floor.
pub(super) struct Blocks {
    len: usize,
    block: usize,
    highest: usize,
    sums: Vec<Complex64>,
}

impl Blocks {
    /// For a record of `len` samples, up to `highest` cycles a record. `None` where nothing lies
    /// between that and the lowest that can be searched, or too much does.
    pub(super) fn new(len: usize, highest: usize) -> Option<Self> {
        let neighbours = (highest as f64 * (1.0 + SPAN)) as usize + 2;
        let count = BLOCKS_EACH * neighbours;
        (highest > LOWEST && count <= MOST_BLOCKS && count <= len).then(|| {
            let block = len / count;
            Self {
                len,
                block,
                highest,
                sums: vec![Complex64::ZERO; len.div_ceil(block) + 1],
            }
        })
    }

    /// Takes samples from index `at` on.
    pub(super) fn push(&mut self, at: usize, values: &[f64]) {
        for (index, value) in values.iter().enumerate() {
            let place = (at + index) / self.block;
            let share = ((at + index) % self.block) as f64 / self.block as f64;
            self.sums[place] += value * (1.0 - share);
            self.sums[place + 1] += value * share;
        }
    }

    /// The floor, for squared sums over `norm`.
    pub(super) fn floor(mut self, norm: f64) -> SlowFloor {
        let count = self.sums.len();
        // The last blocks may be short: the ordinates' spacing is one over the padded length.
        let spacing = self.len as f64 / (count * self.block) as f64;
        FftPlanner::new()
            .plan_fft_forward(count)
            .process(&mut self.sums);
        let powers: Vec<f64> = self.sums[..count / 2]
            .iter()
            .enumerate()
            .map(|(k, one)| {
                let x = PI * k as f64 / count as f64;
                let passed = if k == 0 { 1.0 } else { (x.sin() / x).powi(2) };
                one.norm_sqr() / (passed * passed * norm)
            })
            .collect();
        let densities = (0..=self.highest + 1)
            .map(|k| {
                let span = span(k);
                let mut near = powers[k.saturating_sub(span)..=k + span].to_vec();
                median(&mut near).unwrap_or(0.0) / LN_2
            })
            .collect();
        SlowFloor { spacing, densities }
    }
}

fn span(k: usize) -> usize {
    (SPAN * k as f64) as usize
}

/// Density of the record without its lines, at low frequencies.
pub(super) struct SlowFloor {
    /// Cycles a record from one ordinate to the next.
    spacing: f64,
    densities: Vec<f64>,
}

impl SlowFloor {
    /// Slowest that is searched, cycles a record.
    pub(super) const fn lowest() -> f64 {
        LOWEST as f64
    }

    /// At `cycles` a record.
    pub(super) fn at(&self, cycles: f64) -> f64 {
        let place = (cycles / self.spacing).clamp(0.0, (self.densities.len() - 1) as f64);
        let below = (place as usize).min(self.densities.len() - 2);
        let share = place - below as f64;
        self.densities[below] * (1.0 - share) + self.densities[below + 1] * share
    }

    /// Probability that noise exceeds `ratio` times this floor at `cycles` a record.
    pub(super) fn tail(cycles: f64, ratio: f64) -> f64 {
        let count = 2 * span(cycles as usize) + 1;
        let log: f64 = (0..count.div_ceil(2))
            .map(|gap| {
                let left = (count - gap) as f64;
                -(ratio / LN_2 / left).ln_1p()
            })
            .sum();
        log.exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::line_tests::{add_tone, white};
    use crate::spectrum::record_lines::search;

    #[test]
    fn noise_exceeds_as_often_as_it_should() {
        const LEN: usize = 1 << 17;
        const HIGHEST: usize = 2000;
        let (mut beyond, mut expected, mut total) = (0.0, 0.0, 0.0);
        for seed in 0..6 {
            let record = white(seed, LEN);
            let mut blocks = Blocks::new(LEN, HIGHEST).unwrap();
            blocks.push(0, &record);
            let powers = {
                let mut all: Vec<Complex64> =
                    record.iter().map(|&x| Complex64::new(x, 0.0)).collect();
                FftPlanner::new().plan_fft_forward(LEN).process(&mut all);
                all
            };
            let floor = blocks.floor(LEN as f64);
            for (k, power) in powers.iter().enumerate().take(HIGHEST).skip(LOWEST) {
                let ratio = power.norm_sqr() / LEN as f64 / floor.at(k as f64);
                beyond += f64::from(ratio > 4.0);
                expected += SlowFloor::tail(k as f64, 4.0);
                total += 1.0;
            }
        }
        // Neighbours share a median, which correlates them weakly: 5 sigma of independent ones.
        let sd = f64::sqrt(expected);
        assert!(
            (beyond - expected).abs() < 5.0 * sd,
            "{beyond} of {total}, {expected} expected; seeds 0..6"
        );
        // The median's own error matters at the lowest: without it e^-20.
        assert!(SlowFloor::tail(64.0, 20.0) > 10.0 * f64::exp(-20.0));
    }

    #[test]
    fn noise_that_rises_does_not_fold_back() {
        const LEN: usize = 1 << 17;
        // A difference of neighbours, and a tenth of a thousandth of it that is white.
        let fast = white(20, LEN);
        let slow = white(21, LEN);
        let record = |share: f64| -> Vec<f64> {
            (0..LEN)
                .map(|n| share * (fast[n] - fast[n.saturating_sub(1)]) + 1e-2 * slow[n])
                .collect()
        };
        let floor = |share: f64| {
            let mut blocks = Blocks::new(LEN, 500).unwrap();
            blocks.push(0, &record(share));
            let floor = blocks.floor(LEN as f64);
            (LOWEST..500).map(|k| floor.at(k as f64)).sum::<f64>()
        };
        // Its own share of the band; blocks without the sharing fold back ten times as much.
        let own = |k: usize| (2.0 * (PI * k as f64 / LEN as f64).sin()).powi(2) / 1e-4;
        let expected = 1.0 + (LOWEST..500).map(own).sum::<f64>() / (500 - LOWEST) as f64;
        // Some 550 ordinates, each known to 1.44 by its median: 5 sigma.
        let ratio = floor(1.0) / floor(0.0) / expected;
        assert!((ratio - 1.0).abs() < 0.31, "{ratio}, seeds 20 and 21");
    }

    #[test]
    fn a_slow_line_in_a_walk_is_found() {
        const LEN: usize = 1 << 17;
        for seed in 10..16 {
            let mut level = 0.0;
            let mut record: Vec<f64> = white(seed, LEN)
                .iter()
                .map(|step| {
                    level += step;
                    level
                })
                .collect();
            let lines = search(record.as_slice(), 1.0, 0.01).unwrap();
            assert!(lines.is_empty(), "seed {seed}: {lines:?}");
            // Density 1 / (2 pi f)^2, and 60 nats: A^2 N / (4 S).
            let cycles = (80 + 17 * (seed as usize - 10)) as f64 / LEN as f64;
            let density = (2.0 * PI * cycles).powi(-2);
            add_tone(
                &mut record,
                (240.0 * density / LEN as f64).sqrt(),
                cycles,
                1.0,
            );
            let lines = search(record.as_slice(), 1.0, 0.01).unwrap();
            assert_eq!(lines.len(), 1, "seed {seed}: {lines:?}");
            let miss = (lines[0].frequency_hz - cycles) / lines[0].frequency_sd_hz;
            assert!(miss.abs() < 5.0, "seed {seed}: {miss} sigma");
        }
    }
}
