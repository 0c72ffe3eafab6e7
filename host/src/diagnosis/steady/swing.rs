//! Noise whose strength swings as a cosine: by maximum likelihood from its powers over time.
//!
//! The powers `p` of short blocks are chi-squared with `n` degrees of freedom each about
//!
//! ```text
//! v = c ((1 - s) + s <(1 + a cos(w t) - b sin(w t))^2> / (1 + (a^2 + b^2) / 2))        (mean over the block)
//! ```
//!
//! `s` being the share of the mean power that swings, whose log-likelihood `-1/2 sum n (ln v + p / v)` is climbed by Fisher scoring.

mod climb;

use std::f64::consts::TAU;

use nalgebra::{Matrix4, Vector3, Vector4};

use crate::diagnosis::record::envelope::{Envelope, of_share};
use crate::diagnosis::record::powers::{BLOCK, Powers};
use crate::diagnosis::statistic::p_value;

/// Powers that follow a cosine.
#[derive(Debug, Clone, PartialEq)]
pub struct Swing {
    /// Logarithm of the power `c`, and the cosine's two parts, about the middle of the record.
    log_power: f64,
    parts: [f64; 2],
    /// Cycles a block.
    frequency: f64,
    /// Blocks up to the middle.
    middle: f64,
    /// Share of the power that swings, in the mean.
    share: f64,
    /// Covariance of logarithm, parts and frequency.
    covariance: Matrix4<f64>,
}

/// What is left of a swing at multiples of its frequency.
#[derive(Debug, Clone, Copy)]
pub struct Harmonics {
    /// Their standard deviation, over the mean power.
    pub sd: f64,
    /// Probability of as much by chance.
    pub p_value: f64,
}

impl Swing {
    /// No cosine: the mean of the powers.
    pub fn steady(powers: &Powers) -> Self {
        let pairs = || powers.powers.iter().zip(&powers.counts);
        let count: f64 = powers.counts.iter().sum();
        Self {
            log_power: (pairs().map(|(p, n)| p * n).sum::<f64>() / count).ln(),
            parts: [0.0; 2],
            frequency: 0.5,
            middle: 0.5 * powers.powers.len() as f64,
            share: 1.0,
            covariance: Matrix4::zeros(),
        }
    }

    fn depth(&self) -> f64 {
        self.parts[0].hypot(self.parts[1])
    }

    /// Angle at the middle of a block.
    fn angle(&self, block: usize) -> f64 {
        TAU * self.frequency * (block as f64 + 0.5 - self.middle)
    }

    /// Expected power of a block, and what its logarithm changes by with the four numbers.
    fn expected(&self, block: usize) -> (f64, Vector4<f64>) {
        let [a, b] = self.parts;
        let angle = self.angle(block);
        let (sine, cosine) = angle.sin_cos();
        let (sine_2, cosine_2) = (2.0 * angle).sin_cos();
        // Means over a block of the first two harmonics.
        let of_block = |order: f64| {
            let half = 0.5 * TAU * order * self.frequency;
            half.sin() / half
        };
        let (one, two) = (of_block(1.0), of_block(2.0));
        let square = 1.0
            + 0.5 * (a * a + b * b)
            + 2.0 * one * (a * cosine - b * sine)
            + two * (0.5 * (a * a - b * b) * cosine_2 - a * b * sine_2);
        let by_a = a + 2.0 * one * cosine + two * (a * cosine_2 - b * sine_2);
        let by_b = b - 2.0 * one * sine - two * (b * cosine_2 + a * sine_2);
        let by_angle = -2.0 * one * (a * sine + b * cosine)
            - two * ((a * a - b * b) * sine_2 + 2.0 * a * b * cosine_2);
        let by_frequency = by_angle * TAU * (block as f64 + 0.5 - self.middle);
        // Over its mean, so that the share is one of the mean power.
        let mean = 1.0 + 0.5 * (a * a + b * b);
        let swings = square / mean;
        let by = Vector3::new(by_a - swings * a, by_b - swings * b, by_frequency) / mean;
        let all = of_share(self.share, swings);
        let by = by * (self.share / all);
        let slope = Vector4::new(1.0, by[0], by[1], by[2]);
        (self.log_power.exp() * all, slope)
    }

    /// Log-likelihood of powers, but for what is the same for all swings.
    pub fn score(&self, powers: &Powers) -> f64 {
        let pairs = powers.powers.iter().zip(&powers.counts).enumerate();
        let scores = pairs
            .filter(|(_, (_, n))| **n > 0.0)
            .map(|(block, (p, n))| {
                let (expected, _) = self.expected(block);
                -0.5 * n * (expected.ln() + p / expected)
            });
        scores.sum()
    }

    /// A swing that is known, of a `share` of the power, with the likeliest power.
    pub fn known(powers: &Powers, swing: &Envelope, share: f64) -> Self {
        let steady = Self::steady(powers);
        let frequency = BLOCK as f64 / swing.period;
        let (sine, cosine) = (swing.phase_rad + TAU * frequency * steady.middle).sin_cos();
        let mut known = Self {
            log_power: 0.0,
            parts: [swing.depth * cosine, swing.depth * sine],
            frequency,
            share,
            ..steady
        };
        let pairs = powers.powers.iter().zip(&powers.counts).enumerate();
        let ratios = pairs.map(|(block, (power, n))| n * power / known.expected(block).0);
        known.log_power = (ratios.sum::<f64>() / powers.counts.iter().sum::<f64>()).ln();
        known
    }

    /// Second and third harmonics, each of any phase, that are left in powers over the swing.
    pub fn harmonics(&self, left: &Powers) -> Harmonics {
        let (mut square, mut variance) = (0.0, 0.0);
        for order in [2.0, 3.0] {
            let (mut sums, mut squares) = ([0.0; 2], [0.0; 2]);
            let pairs = left.powers.iter().zip(&left.counts).enumerate();
            for (block, (power, n)) in pairs {
                let (sine, cosine) = (order * self.angle(block)).sin_cos();
                for (place, wave) in [cosine, sine].into_iter().enumerate() {
                    sums[place] += n * (power - 1.0) * wave;
                    // A power has the relative variance 2 / n.
                    squares[place] += 2.0 * n * wave * wave;
                }
            }
            for (sum, scatter) in sums.iter().zip(squares) {
                square += sum * sum / scatter;
                // Half the square of an amplitude, less what chance makes of it.
                variance += 2.0 * (sum * sum - scatter) / (scatter * scatter);
            }
        }
        Harmonics {
            sd: variance.max(0.0).sqrt(),
            p_value: p_value::chi_squared(square, 4.0),
        }
    }

    /// As depth, period and phase at the first sample, with their standard deviations.
    pub fn named(&self) -> Option<(Envelope, Envelope)> {
        let [a, b] = self.parts;
        let (depth, length) = (self.depth(), BLOCK as f64);
        let phase = b.atan2(a) - TAU * self.frequency * self.middle;
        let sd = |by: Vector4<f64>| (by.transpose() * self.covariance * by)[0].sqrt();
        let by_depth = Vector4::new(0.0, a / depth, b / depth, 0.0);
        let turn = depth * depth;
        let by_phase = Vector4::new(0.0, -b / turn, a / turn, -TAU * self.middle);
        let by_period = Vector4::new(0.0, 0.0, 0.0, length / self.frequency.powi(2));
        let swing = Envelope {
            depth,
            period: length / self.frequency,
            phase_rad: phase - TAU * (phase / TAU).round(),
        };
        let sd = Envelope {
            depth: sd(by_depth),
            period: sd(by_period),
            phase_rad: sd(by_phase),
        };
        let all = [depth, sd.depth, sd.period, sd.phase_rad];
        all.iter().all(|one| one.is_finite()).then_some((swing, sd))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::{Gaussian, Seed};

    /// Powers of white noise whose deviation has this factor at each sample.
    fn powers(seed: u64, blocks: usize, factor: impl Fn(usize) -> f64) -> Powers {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut sample = |index: usize| (factor(index) * noise.draw()).powi(2);
        let mut power = |block: usize| {
            let sum: f64 = (block * BLOCK..(block + 1) * BLOCK).map(&mut sample).sum();
            sum / BLOCK as f64
        };
        Powers {
            powers: (0..blocks).map(&mut power).collect(),
            counts: vec![BLOCK as f64; blocks],
        }
    }

    #[test]
    fn the_numbers_of_a_swing_are_within_their_deviations() {
        const RECORDS: u64 = 60;
        let mut squares = [0.0; 3];
        for seed in 0..RECORDS {
            let at = seed as f64 / RECORDS as f64;
            let swing = Envelope {
                depth: 0.2 + 0.6 * at,
                // From 9 blocks to 90.
                period: BLOCK as f64 * 9.0 * 10_f64.powf((7.0 * at).fract()),
                phase_rad: 6.0 * (11.0 * at).fract() - 3.0,
            };
            let blocks = 2000 + 13 * seed as usize;
            let powers = powers(seed, blocks, |index| swing.factor(index));
            // An ordinate of the periodogram is within half a cycle a record of it.
            let record = (blocks * BLOCK) as f64;
            let ordinate = (record / swing.period).round();
            let fit = Swing::new(&powers, record / ordinate, 1.0).expect("plain");
            let (found, sd) = fit.named().expect("plain");
            let turned = (found.phase_rad - swing.phase_rad) / TAU;
            let off = [
                (found.depth - swing.depth) / sd.depth,
                (found.period - swing.period) / sd.period,
                TAU * (turned - turned.round()) / sd.phase_rad,
            ];
            for (square, off) in squares.iter_mut().zip(off) {
                // 180 numbers beyond 4.5 sigma: once in 800.
                assert!(off.abs() < 4.5, "seed {seed}: {off:?} for {swing:?}");
                *square += off * off;
            }
        }
        // Mean squares of 60, each of one: four sigma.
        for square in squares {
            let z = (square / RECORDS as f64 - 1.0) / (2.0 / RECORDS as f64).sqrt();
            assert!(z.abs() < 4.0, "{squares:?} of 60, seeds from 0");
        }
    }

    #[test]
    fn a_cosine_leaves_no_harmonics_and_a_switch_does() {
        const RECORDS: u64 = 60;
        let p = |seed: u64, factor: &dyn Fn(usize) -> f64| {
            let powers = powers(seed, 3000, factor);
            let fit = Swing::new(&powers, 3000.0, 1.0).expect("plain");
            let mut left = powers.clone();
            for (block, power) in left.powers.iter_mut().enumerate() {
                *power /= fit.expected(block).0;
            }
            fit.harmonics(&left).p_value
        };
        let cosine = Envelope {
            depth: 0.3,
            period: 3000.0,
            phase_rad: 0.0,
        };
        let low = (0..RECORDS).filter(|&seed| p(seed, &|index| cosine.factor(index)) < 0.01);
        // 0.6 are expected: 5 or more have a probability of 4e-4.
        let low: Vec<u64> = low.collect();
        assert!(low.len() < 5, "seeds {low:?}");
        for seed in 100..110 {
            let switched = |index: usize| if index % 3000 < 1500 { 1.0 } else { 1.5 };
            let p = p(seed, &switched);
            assert!(p < 1e-6, "seed {seed}: {p:e}");
        }
    }
}
