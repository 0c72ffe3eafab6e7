//! The likelihood ratio of a loss: gains of all lines over steady ones, for every moment and length.

use std::f64::consts::TAU;

use rustfft::num_complex::Complex64;

use super::line::{LINE_REACH, Line};
use super::moment::{Best, Posterior, posterior};

/// Log-likelihood within which a length or a moment is as good as the best: 95 %.
pub(super) const AS_GOOD: f64 = 2.0;

/// Share of the record at each end in which no loss is looked for: a choice. A jump by half a cycle
/// there takes 8 % off a line's power.
const MARGIN: f64 = 0.02;

/// Error of the tables, at most, as a share of the gain: they know a moment by its block alone. A
/// tenth is a choice; more of them would be followed to the sample.
const TABLE_SHARE: f64 = 0.1;

/// Gains over steady lines for all moments and lengths.
pub(crate) struct Tables {
    pub(crate) longest: usize,
    /// First block that a loss is looked for ahead of.
    pub(crate) first: usize,
    /// Of all lines, by moment, then length.
    pub(crate) sum: Vec<f64>,
}

impl Tables {
    pub(crate) fn new(lines: &[Line], longest: usize) -> Self {
        let count = lines[0].seen.sums.len();
        let first = ((MARGIN * count as f64) as usize).max(1);
        let each: Vec<Vec<f64>> = lines
            .iter()
            .map(|line| gains(line, first..count - first, longest))
            .collect();
        let sum = (0..each[0].len())
            .map(|at| each.iter().map(|gains| gains[at]).sum())
            .collect();
        Self {
            longest,
            first,
            sum,
        }
    }

    /// The best moment for each length that may be the best, ascending.
    pub(crate) fn candidates(&self) -> Vec<Best> {
        let all = (0..self.longest).map(|length| {
            let gains = self.sum[length..].iter().step_by(self.longest);
            let (moment, gain) = gains
                .enumerate()
                .max_by(|a, b| a.1.total_cmp(b.1))
                .map_or((0, 0.0), |(moment, gain)| (moment, *gain));
            Best {
                place: self.first + moment,
                samples: length + 1,
                gain,
            }
        });
        let all: Vec<Best> = all.collect();
        let highest = all.iter().map(|one| one.gain).fold(f64::MIN, f64::max);
        let least = highest - 2.0 * AS_GOOD - TABLE_SHARE * highest.max(0.0);
        all.into_iter().filter(|one| one.gain > least).collect()
    }

    /// Logarithm of the likelihood ratio averaged over all moments and lengths.
    pub(crate) fn mean_ratio(&self) -> f64 {
        log_sum(&self.sum) - (self.sum.len() as f64).ln()
    }

    /// The moment, in samples for blocks of `len`.
    pub(crate) fn moment(&self, samples: usize, len: usize) -> Posterior {
        let gains = self.sum[samples - 1..].iter().step_by(self.longest);
        let found = posterior(&gains.copied());
        let place = |blocks: f64| (self.first as f64 + blocks) * len as f64;
        Posterior {
            middle: place(found.middle),
            sd: found.sd * len as f64,
            lo: place(found.lo),
            hi: place(found.hi),
        }
    }
}

/// Logarithm of the sum of exponentials.
pub(crate) fn log_sum(gains: &[f64]) -> f64 {
    let highest = gains.iter().copied().fold(f64::MIN, f64::max);
    let sum: f64 = gains.iter().map(|gain| (gain - highest).exp()).sum();
    highest + sum.ln()
}

/// Gains of one line over a steady one for losses of 1 to `longest` samples ahead of each block of
/// `places`, the frequency fitted: the best of a grid, and from there one step of Newton's.
pub(crate) fn gains(line: &Line, places: std::ops::Range<usize>, longest: usize) -> Vec<f64> {
    /// Cycles a record between points of the grid.
    const STEP: f64 = 0.25;
    let seen = &line.seen;
    let count = seen.sums.len();
    let norm = seen.noise * seen.weights.iter().sum::<f64>();
    // Running sums of y e^(-j v w), of v and of v^2 times that, v the angle a unit of offset.
    let running: Vec<Vec<[Complex64; 3]>> = (-(LINE_REACH / STEP) as i32
        ..=(LINE_REACH / STEP) as i32)
        .map(|point| {
            let offset = line.offset + STEP * f64::from(point);
            let mut sums = [Complex64::ZERO; 3];
            let mut running = vec![sums];
            for (block, sum) in seen.sums.iter().enumerate() {
                let v = TAU * ((block as f64 + 0.5) / count as f64 - 0.5);
                let shifted = sum * Complex64::from_polar(1.0, -offset * v);
                sums[0] += shifted;
                sums[1] += shifted * v;
                sums[2] += shifted * (v * v);
                running.push(sums);
            }
            running
        })
        .collect();
    let back: Vec<Complex64> = (1..=longest)
        .map(|samples| Complex64::from_polar(1.0, -TAU * seen.cycles * samples as f64))
        .collect();
    let mut gains = Vec::with_capacity(places.len() * longest);
    for place in places {
        for &back in &back {
            let total = |sums: &[[Complex64; 3]], power: usize| {
                let before = sums[place][power];
                before + (sums[count][power] - before) * back
            };
            let mut highest = (0.0, &running[0]);
            for sums in &running {
                let power = total(sums, 0).norm_sqr();
                if power > highest.0 {
                    highest = (power, sums);
                }
            }
            let (power, sums) = highest;
            let [zero, one, two] = [total(sums, 0), total(sums, 1), total(sums, 2)];
            let slope = 2.0 * (zero.conj() * one).im;
            let bend = 2.0 * (one.norm_sqr() - (zero.conj() * two).re);
            let step = if bend < 0.0 {
                (-slope / bend).clamp(-STEP, STEP)
            } else {
                0.0
            };
            let power = power + slope * step + 0.5 * bend * step * step;
            gains.push(power / norm - line.gain);
        }
    }
    gains
}
