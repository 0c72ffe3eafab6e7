//! The stretch of a record whose power departs most from the rest, in windows of all lengths and places.

use std::ops::Range;

use crate::diagnosis::record::powers::{BLOCK, Powers};
use crate::diagnosis::statistic::p_value;

/// Places at which a window of each length begins, a window's length: a choice. A window need only
/// lie near, for both ends are free afterwards.
const PLACES: usize = 4;

/// A stretch of the record that is noisier, or quieter, than the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Burst {
    /// First sample and the one after the last.
    pub range: Range<usize>,
    /// Standard deviation within it over that outside.
    pub factor: f64,
    /// Standard deviation of the logarithm of the factor.
    pub log_factor_sd: f64,
    /// Samples over which the level is averaged that stays as it is, where that is not its length.
    pub level: Option<f64>,
    /// Uncertainty of both ends, samples.
    pub end_sd: f64,
    /// Gain in log-likelihood over noise of one strength, nats.
    pub nats: f64,
    /// The same on blocks that the factor was not fitted to, if the stretch has some of both.
    pub held_nats: Option<f64>,
    /// Probability of as large a gain anywhere in steady noise.
    pub p_value: f64,
}

/// The stretch that departs most from the rest, if it does so at a family-wise `level`.
pub fn burst(powers: &Powers, level: f64) -> Option<Burst> {
    let blocks = powers.powers.len();
    let sums = Sums::new(powers);
    let mut best = (0.0, 0..0);
    let mut trials = 0.0;
    let mut length = 1;
    while length <= blocks / 2 {
        let stride = (length / PLACES).max(1);
        for start in (0..=blocks - length).step_by(stride) {
            trials += 1.0;
            let gain = sums.gain(start..start + length);
            if gain > best.0 {
                best = (gain, start..start + length);
            }
        }
        length *= 2;
    }
    let (_, range) = best;
    if range.is_empty() {
        return None;
    }
    let range = settled(&sums, range, blocks);
    let nats = sums.gain(range.clone());
    // The blocks at both ends are its own in part only.
    let whole_blocks = match range.len() {
        0..=2 => range.clone(),
        _ => range.start + 1..range.end - 1,
    };
    let (inside, outside) = (sums.both(whole_blocks).0, sums.both(range.clone()).1);
    let ratio = inside.0 / outside.0;
    // Free ends make each of the trials some tens: the search's own maximum is judged.
    let one = sums.tail(range.clone());
    let p_value = p_value::searched(one, 16.0 * trials);
    let log_factor_sd = (0.5 / inside.1 + 0.5 / outside.1).sqrt();
    (p_value < level).then(|| Burst {
        range: range.start * BLOCK..range.end * BLOCK,
        factor: ratio.sqrt(),
        log_factor_sd,
        level: None,
        // A change of variance is placed to within a few of 1 / Kullback-Leibler divergence.
        end_sd: (BLOCK as f64).hypot(2.0 / (0.5 * (ratio - 1.0 - ratio.ln())).max(1e-6)),
        nats,
        held_nats: held_out(powers, &range),
        p_value,
    })
}

/// A stretch of so many `blocks` with both ends where its gain is largest, each moved by itself until neither moves.
fn settled(sums: &Sums, mut range: Range<usize>, blocks: usize) -> Range<usize> {
    /// Turns, at most: a choice.
    const TURNS: usize = 8;
    for _ in 0..TURNS {
        let before = range.clone();
        let reach = range.len().max(4);
        let starts = range.start.saturating_sub(reach)..range.end;
        range.start = starts
            .max_by(|&a, &b| sums.gain(a..range.end).total_cmp(&sums.gain(b..range.end)))
            .unwrap_or(range.start);
        let ends = range.start + 1..=(range.end + reach).min(blocks);
        range.end = ends
            .max_by(|&a, &b| {
                sums.gain(range.start..a)
                    .total_cmp(&sums.gain(range.start..b))
            })
            .unwrap_or(range.end);
        if range == before {
            break;
        }
    }
    range
}

/// Gain in log-likelihood of the odd blocks for variances within and outside of `range` that are
/// fitted to the even ones, over one variance for all; `None` where a part has no such blocks.
fn held_out(powers: &Powers, range: &Range<usize>) -> Option<f64> {
    let half = |parity: usize| {
        let mut half = powers.clone();
        for count in half.counts.iter_mut().skip(1 - parity).step_by(2) {
            *count = 0.0;
        }
        Sums::new(&half).both(range.clone())
    };
    let ((inside, n), (outside, m)) = half(0);
    let all = (inside * n + outside * m) / (n + m);
    let ((held_inside, n), (held_outside, m)) = half(1);
    let score =
        |count: f64, square: f64, variance: f64| -0.5 * count * (variance.ln() + square / variance);
    let gain = score(n, held_inside, inside) + score(m, held_outside, outside)
        - score(n, held_inside, all)
        - score(m, held_outside, all);
    gain.is_finite().then_some(gain)
}

/// Cumulative sums over blocks.
struct Sums {
    squares: Vec<f64>,
    counts: Vec<f64>,
}

impl Sums {
    fn new(powers: &Powers) -> Self {
        let cumulate = |values: &mut dyn Iterator<Item = f64>| {
            let mut sum = 0.0;
            std::iter::once(0.0)
                .chain(values.map(|value| {
                    sum += value;
                    sum
                }))
                .collect::<Vec<f64>>()
        };
        let pairs = || powers.powers.iter().zip(&powers.counts);
        Self {
            squares: cumulate(&mut pairs().map(|(power, count)| power * count)),
            counts: cumulate(&mut powers.counts.iter().copied()),
        }
    }

    /// Mean square and samples, within and outside.
    fn both(&self, range: Range<usize>) -> ((f64, f64), (f64, f64)) {
        let within = |sums: &[f64]| sums[range.end] - sums[range.start];
        let (square, count) = (within(&self.squares), within(&self.counts));
        let all = (
            self.squares[self.squares.len() - 1],
            self.counts[self.counts.len() - 1],
        );
        let rest = (all.0 - square, all.1 - count);
        (
            (square / count.max(1.0), count),
            (rest.0 / rest.1.max(1.0), rest.1),
        )
    }

    /// Gain in log-likelihood of a variance of its own.
    fn gain(&self, range: Range<usize>) -> f64 {
        let ((inside, n), (outside, m)) = self.both(range);
        if n < 1.0 || m < 1.0 || inside <= 0.0 || outside <= 0.0 {
            return 0.0;
        }
        let all = (inside * n + outside * m) / (n + m);
        0.5 * ((n + m) * all.ln() - n * inside.ln() - m * outside.ln())
    }

    /// Probability of a mean square as far off, either way, for steady noise.
    fn tail(&self, range: Range<usize>) -> f64 {
        let ((inside, n), (outside, _)) = self.both(range);
        p_value::mean_square(inside / outside, n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    #[test]
    fn a_stretch_is_held_out_by_blocks_that_its_factor_was_not_fitted_to() {
        const STRETCH: Range<usize> = 128..256;
        let gain = |seed: u64, ratio: f64| {
            let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
            let power = |block: usize| {
                let squares: f64 = (0..BLOCK).map(|_| noise.draw().powi(2)).sum();
                let ratio = if STRETCH.contains(&block) { ratio } else { 1.0 };
                ratio * squares / BLOCK as f64
            };
            let powers = Powers {
                powers: (0..512).map(power).collect(),
                counts: vec![BLOCK as f64; 512],
            };
            held_out(&powers, &STRETCH).expect("blocks of both halves")
        };
        let there = gain(0, 1.5);
        // Half of the samples, 1.5 and 1 beside a mean of 1.125: in nats 0.5 (n ln 1.125 - n / 4 ln 1.5).
        let nats = 0.25 * 512.0 * BLOCK as f64 * (1.125_f64.ln() - 0.25 * 1.5_f64.ln());
        // Of which the deviation is the root of twice as much, to first order.
        let off = (there - nats).abs();
        assert!(off < 5.0 * (2.0 * nats).sqrt(), "seed 0: {there} of {nats}");
        // Where there is nothing, `e o - e^2 / 2` of two normal numbers: mean -1/2, variance 3/2. On the blocks that
        // it was fitted to it would gain as much as it loses.
        let mean = (1..201).map(|seed| gain(seed, 1.0)).sum::<f64>() / 200.0;
        let five_sigma = 5.0 * (1.5_f64 / 200.0).sqrt();
        assert!((mean + 0.5).abs() < five_sigma, "{mean}, seeds 1 to 200");
    }

    #[test]
    fn a_short_burst_is_as_loud_as_its_whole_blocks() {
        /// A stretch that begins and ends within a block, of four times the power.
        const STRETCH: Range<usize> = 100_040..100_700;
        const RECORDS: u64 = 40;
        let mut logs = Vec::new();
        for seed in 0..RECORDS {
            let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
            let mut values = (0..1 << 18).map(|n| {
                let factor = if STRETCH.contains(&n) { 2.0 } else { 1.0 };
                factor * noise.draw()
            });
            let blocks = (1 << 18) / BLOCK;
            let power = |_| {
                values
                    .by_ref()
                    .take(BLOCK)
                    .map(|one| one * one)
                    .sum::<f64>()
            };
            let powers = Powers {
                powers: (0..blocks)
                    .map(power)
                    .map(|sum| sum / BLOCK as f64)
                    .collect(),
                counts: vec![BLOCK as f64; blocks],
            };
            let burst = burst(&powers, 1e-3).expect("four times the power is plain");
            logs.push((burst.factor / 2.0).ln() / burst.log_factor_sd);
        }
        // Mean of 40 in units of their own deviation: 4 sigma. With the ends it is at -0.8.
        let mean = logs.iter().sum::<f64>() / RECORDS as f64;
        assert!(
            mean.abs() < 4.0 / (RECORDS as f64).sqrt(),
            "{mean}, seeds 0 to 39"
        );
    }
}
