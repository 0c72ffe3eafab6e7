//! A record seen at one line: shifted down to zero frequency, in blocks.
//!
//! Each block's straight line is taken out first, so that drift does not leak to the line, and
//! what is not usable counts for nothing. Of a line of few cycles it takes a share with it, which depends
//! on the phase in the block and would be a line of its own beside a strong one: it is given back. With `n_b` usable samples in block `b` at the middle
//! `u_b` (a share of the record), a line of complex amplitude `a` that is `w` cycles a record away
//! from the frequency it is looked at gives
//!
//! ```text
//! y_b = a n_b e^(2 pi j w u_b) + noise,    <|noise|^2> = 4 n_b rate S(f)
//! ```
//!
//! with independent blocks, `S` the two-sided density about the line.

use std::f64::consts::{LN_2, TAU};

use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

use super::part::Part;
use crate::numeric::order::median;
use crate::numeric::top::golden_section;

/// Share of the band of the blocks on either side of its middle that does not count as noise, one
/// over this: there stand the skirts of a line that jumps. An eighth is a choice, and leaves three
/// quarters of the ordinates.
const INNER: usize = 8;

/// A jump of the phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Where, in blocks from the start; a fraction lies within a block.
    pub place: f64,
    /// By how much the phase advances, radians.
    pub angle: f64,
}

/// What a jump makes of a steady line in each block: nothing ahead of it, a turn behind it, a mean of both within.
fn turned(turn: Option<Turn>) -> impl Fn(usize) -> Complex64 {
    let by = turn.map(|turn| (turn.place, Complex64::cis(turn.angle)));
    move |block| {
        by.map_or(Complex64::ONE, |(place, angle)| {
            let before = (place - block as f64).clamp(0.0, 1.0);
            before + (1.0 - before) * angle
        })
    }
}

/// A record in blocks, their straight lines taken out.
pub struct Blocks {
    /// How many samples a block has.
    pub len: usize,
    /// The samples; zero where not usable.
    pub values: Vec<f64>,
    /// Usable samples of each block.
    pub usable: Vec<f64>,
}

impl Blocks {
    /// Cuts `values` into `count` blocks; samples beyond the last whole one are left out.
    pub fn new(values: &[f64], count: usize, usable: impl Fn(usize) -> bool) -> Self {
        let len = values.len() / count;
        let mut values = values[..count * len].to_vec();
        let middle = 0.5 * (len as f64 - 1.0);
        let squares: f64 = (0..len).map(|i| (i as f64 - middle).powi(2)).sum();
        let mut counts = Vec::with_capacity(count);
        for (block, part) in values.chunks_exact_mut(len).enumerate() {
            let mean = part.iter().sum::<f64>() / len as f64;
            let slope = part
                .iter()
                .enumerate()
                .map(|(i, value)| (i as f64 - middle) * value)
                .sum::<f64>()
                / squares;
            let mut good = 0;
            for (i, value) in part.iter_mut().enumerate() {
                *value = if usable(block * len + i) {
                    good += 1;
                    *value - mean - slope * (i as f64 - middle)
                } else {
                    0.0
                };
            }
            counts.push(f64::from(good));
        }
        Self {
            len,
            values,
            usable: counts,
        }
    }

    /// The same blocks of other values, their straight lines taken out again; what is not usable
    /// stays zero.
    pub fn with(&self, values: &[f64]) -> Self {
        let kept: Vec<bool> = self.values.iter().map(|value| *value != 0.0).collect();
        Self::new(values, self.usable.len(), |index| kept[index])
    }

    /// The record at `cycles` a sample.
    pub fn at(&self, cycles: f64) -> Demodulated {
        let sums = self.values.chunks_exact(self.len).enumerate();
        let sums = sums.map(|(block, part)| {
            // The fraction of a cycle, so that long records lose no digits.
            let turn = TAU * ((block * self.len) as f64 * cycles).fract();
            Part::new(part, turn, TAU * cycles).line(self.usable[block])
        });
        let sums: Vec<Complex64> = sums.collect();
        let noise = noise(&sums, self.usable.iter().sum());
        Demodulated {
            cycles,
            sums,
            weights: self.usable.clone(),
            noise,
        }
    }
}

/// Noise of a block's sum, for each sample in it: from the middle of the ordinates away from the
/// line, which a neighbouring line does not move.
fn noise(sums: &[Complex64], weight: f64) -> f64 {
    let mut ordinates = sums.to_vec();
    let count = ordinates.len();
    FftPlanner::new()
        .plan_fft_forward(count)
        .process(&mut ordinates);
    let inner = count / INNER;
    let mut powers: Vec<f64> = ordinates[inner..=count - inner]
        .iter()
        .map(|one| one.norm_sqr())
        .collect();
    let median = median(&mut powers).unwrap_or(0.0);
    (median / (LN_2 * weight)).max(f64::MIN_POSITIVE)
}

/// A record at one line as it would be without a jump, whatever the line's frequency.
struct Straight {
    /// Each block's sum, turned back.
    sums: Vec<Complex64>,
    /// What a line of amplitude 1 has in all blocks.
    energy: f64,
    noise: f64,
}

impl Straight {
    fn new(seen: &Demodulated, turn: Option<Turn>) -> Self {
        let turned = turned(turn);
        let blocks = seen.sums.iter().zip(&seen.weights).enumerate();
        let mut energy = 0.0;
        let sums = blocks.map(|(block, (sum, weight))| {
            let turned = turned(block);
            energy += weight * turned.norm_sqr();
            sum * turned.conj()
        });
        Self {
            sums: sums.collect(),
            energy: energy.max(f64::MIN_POSITIVE),
            noise: seen.noise,
        }
    }

    /// What the blocks have in common with a line of amplitude 1, `offset` cycles a record away.
    fn product(&self, offset: f64) -> Complex64 {
        /// Sums that are made side by side, as one waits for the one before it.
        const SIDE_BY_SIDE: usize = 4;
        // A turn from one block to the next: of the 512 blocks at most the last is off by 1e-13.
        let half = Complex64::cis(-0.5 * TAU * offset / self.sums.len() as f64);
        let step = half * half;
        let mut back = [half; SIDE_BY_SIDE];
        for next in 1..SIDE_BY_SIDE {
            back[next] = back[next - 1] * step;
        }
        let stride = step.powu(SIDE_BY_SIDE as u32);
        let mut products = [Complex64::ZERO; SIDE_BY_SIDE];
        for sums in self.sums.chunks(SIDE_BY_SIDE) {
            for ((sum, back), product) in sums.iter().zip(&mut back).zip(&mut products) {
                *product += sum * *back;
                *back *= stride;
            }
        }
        products.into_iter().sum()
    }

    /// What such a line gains in log-likelihood.
    fn gain(&self, offset: f64) -> f64 {
        self.product(offset).norm_sqr() / (self.energy * self.noise)
    }
}

/// A record at one line.
#[derive(Clone)]
pub struct Demodulated {
    /// Frequency that it is looked at, cycles a sample.
    pub cycles: f64,
    /// Each block's sum, `y_b`.
    pub sums: Vec<Complex64>,
    /// Usable samples of each block, `n_b`.
    pub weights: Vec<f64>,
    /// Variance of a block's noise for each of its samples.
    pub noise: f64,
}

impl Demodulated {
    /// Every second block, from `first` (0 or 1) on; the others count for nothing.
    pub fn every_second(&self, first: usize) -> Self {
        let mut half = self.clone();
        for block in (1 - first..half.sums.len()).step_by(2) {
            half.sums[block] = Complex64::ZERO;
            half.weights[block] = 0.0;
        }
        half
    }

    /// What a line of amplitude 1 looks like in a block, for each of its samples.
    pub fn template(&self, block: usize, offset: f64, turn: Option<Turn>) -> Complex64 {
        let middle = (block as f64 + 0.5) / self.sums.len() as f64;
        Complex64::cis(TAU * offset * middle) * turned(turn)(block)
    }

    /// Best amplitude of a line `offset` cycles a record away, and what it gains in log-likelihood.
    pub fn line(&self, offset: f64, turn: Option<Turn>) -> (Complex64, f64) {
        let straight = Straight::new(self, turn);
        let product = straight.product(offset);
        (product / straight.energy, straight.gain(offset))
    }

    /// Best offset within `reach` of `about`, cycles a record, and its gain.
    pub fn best_offset(&self, about: f64, reach: f64, turn: Option<Turn>) -> (f64, f64) {
        /// Cycles a record between looks: a line halfway loses 5 %.
        const STEP: f64 = 0.25;
        /// Sections of what is between two looks: 1e-7 of a cycle a record is left.
        const SECTIONS: u32 = 32;
        let straight = Straight::new(self, turn);
        let gain = |offset| straight.gain(offset);
        let looks = (reach / STEP).ceil() as i32;
        let (mut best, mut highest) = (about, f64::NEG_INFINITY);
        for look in -looks..=looks {
            let offset = about + STEP * f64::from(look);
            let here = gain(offset);
            if here > highest {
                (best, highest) = (offset, here);
            }
        }
        // Between the neighbours.
        let offset = golden_section(best - STEP, best + STEP, SECTIONS, gain);
        (offset, gain(offset))
    }

    /// Log-likelihood, up to a constant, of a given line.
    pub fn log_likelihood(&self, amplitude: Complex64, offset: f64, turn: Option<Turn>) -> f64 {
        let blocks = self.sums.iter().zip(&self.weights).enumerate();
        blocks
            .filter(|(_, (_, weight))| **weight > 0.0)
            .map(|(block, (sum, weight))| {
                let left = sum - amplitude * self.template(block, offset, turn) * *weight;
                -left.norm_sqr() / (weight * self.noise)
            })
            .sum()
    }

    /// What is left of the record within `reach` ordinates of a line, beyond what noise leaves
    /// there on average, in units of log-likelihood.
    pub fn left_over(&self, offset: f64, turn: Option<Turn>, reach: usize) -> f64 {
        let (amplitude, _) = self.line(offset, turn);
        let mut left: Vec<Complex64> = (0..self.sums.len())
            .map(|block| {
                let template = self.template(block, offset, turn);
                // Back to zero frequency.
                let back = self.template(block, offset, None).conj();
                (self.sums[block] - amplitude * template * self.weights[block]) * back
            })
            .collect();
        let count = left.len();
        FftPlanner::new().plan_fft_forward(count).process(&mut left);
        let weight: f64 = self.weights.iter().sum();
        let near = left[..=reach].iter().chain(&left[count - reach..]);
        let power: f64 = near.map(|one| one.norm_sqr()).sum();
        // Amplitude and offset took three halves of an ordinate's two numbers.
        power / (weight * self.noise) - (2.0 * reach as f64 + 1.0 - 1.5)
    }
}
