//! The likelihood ratio of a loss: gains of all lines over steady ones, for every moment and length.

use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

use crate::diagnosis::detect::dropped::demodulate::{Blocks, Demodulated, Turn};
use crate::diagnosis::record::wave::Wave;
use crate::fft::ring::Series;

/// How far from a steady line's best frequency the line may be, cycles a record: four times the
/// 0.74 by which a jump by half a cycle in the middle moves its peaks. Four is a choice.
pub(super) const LINE_REACH: f64 = 3.0;

/// Log-likelihood within which a length or a moment is as good as the best: 95 %.
pub(super) const AS_GOOD: f64 = 2.0;

/// Share of the record at each end in which no loss is looked for: a choice. A jump by half a cycle
/// there takes 8 % off a line's power.
const MARGIN: f64 = 0.02;

/// Blocks on either side of the best in which the moment is looked for sample by sample: a choice.
const ZOOM: usize = 6;

/// Error of the tables, at most, as a share of the gain: they know a moment by its block alone. A
/// tenth is a choice; more of them would be followed to the sample.
const TABLE_SHARE: f64 = 0.1;

/// A line and its best steady fit.
pub(crate) struct Line {
    pub(crate) seen: Demodulated,
    /// Cycles a record from where it is looked at.
    pub(crate) offset: f64,
    /// Gain in log-likelihood over no line.
    pub(crate) gain: f64,
}

impl Line {
    /// The best steady line within `reach` cycles a record of where it is looked at.
    pub(crate) fn new(seen: Demodulated, reach: f64) -> Self {
        let (offset, gain) = seen.best_offset(0.0, reach, None);
        Self { seen, offset, gain }
    }

    pub(crate) fn cycles(&self, offset: f64, block: usize) -> f64 {
        self.seen.cycles + offset / (self.seen.sums.len() * block) as f64
    }
}

/// A line with a jump of phase.
pub(crate) struct Turned {
    pub(crate) samples: usize,
    pub(crate) turn: Turn,
    pub(crate) offset: f64,
    pub(crate) amplitude: Complex64,
    pub(crate) gain: f64,
}

/// The lines with `samples` lost at `place`, in blocks.
pub(crate) fn fitted(lines: &[Line], place: f64, samples: usize) -> Vec<Turned> {
    lines
        .iter()
        .map(|line| {
            let turn = Turn {
                place,
                angle: TAU * line.seen.cycles * samples as f64,
            };
            let (offset, _) = line.seen.best_offset(line.offset, LINE_REACH, Some(turn));
            let (amplitude, gain) = line.seen.line(offset, Some(turn));
            Turned {
                samples,
                turn,
                offset,
                amplitude,
                gain,
            }
        })
        .collect()
}

/// The lines, each without the others and at its own frequency, against the noise that is left
/// when all are out: as `turned` has them, with the loss ahead of sample `index`.
pub(crate) fn cleaned(
    blocks: &Blocks,
    lines: &[Line],
    turned: &[Turned],
    index: usize,
) -> Vec<Line> {
    let samples = turned.first().map_or(0, |turned| turned.samples);
    let mut left = blocks.values.clone();
    for (line, turned) in lines.iter().zip(turned) {
        let wave = Wave::Line {
            cycles: line.cycles(turned.offset, blocks.len),
            cosine: turned.amplitude.re,
            sine: -turned.amplitude.im,
            lost: Some((index, samples as u32)),
        };
        wave.take_out(&mut left);
    }
    let left = blocks.with(&left);
    lines
        .iter()
        .zip(turned)
        .map(|(line, turned)| {
            let cycles = line.cycles(turned.offset, blocks.len);
            let mut seen = left.at(cycles);
            let turn = Turn {
                place: index as f64 / blocks.len as f64,
                angle: TAU * cycles * samples as f64,
            };
            for block in 0..seen.sums.len() {
                let own = turned.amplitude * seen.template(block, 0.0, Some(turn));
                seen.sums[block] += own * seen.weights[block];
            }
            Line::new(seen, 2.0 * LINE_REACH)
        })
        .collect()
}

/// A moment and a number of samples.
#[derive(Clone, Copy)]
pub(crate) struct Best {
    /// First block after the loss.
    pub(crate) place: usize,
    pub(crate) samples: usize,
    pub(crate) gain: f64,
}

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

/// Logarithm of the odds that the other lines give for a loss at `place`, over the lengths that one
/// line by itself leaves open, each by what it is worth to that one. By the fits themselves: to a
/// strong line the rest of a block is worth more than all of a weak one.
pub(crate) fn others(lines: &[Line], loudest: usize, place: f64, longest: usize) -> f64 {
    let (mut all, mut alone) = (Vec::new(), Vec::new());
    for samples in 1..=longest {
        let turned = fitted(lines, place, samples);
        let gain = |line: usize| turned[line].gain - lines[line].gain;
        all.push((0..lines.len()).map(gain).sum());
        alone.push(gain(loudest));
    }
    log_sum(&all) - log_sum(&alone)
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

/// Where a whole number lies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Posterior {
    pub(crate) middle: f64,
    pub(crate) sd: f64,
    /// Ends of the 95 % interval.
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

/// A whole number by its log-likelihoods from 0 on, all alike beforehand.
pub(crate) fn posterior(gains: &(impl Iterator<Item = f64> + Clone)) -> Posterior {
    let highest = gains.clone().fold(f64::NEG_INFINITY, f64::max);
    let weights = || gains.clone().map(|gain| (gain - highest).exp());
    let total: f64 = weights().sum();
    let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
    let (mut lo, mut hi) = (0.0, 0.0);
    for (number, weight) in weights().enumerate() {
        let number = number as f64;
        // Each number stands for itself and half of the way to its neighbours.
        let reached = |share: f64| number - 0.5 + (share * total - sum) / weight;
        for (end, share) in [(&mut lo, 0.025), (&mut hi, 0.975)] {
            if sum < share * total && sum + weight >= share * total {
                *end = reached(share);
            }
        }
        sum += weight;
        first += weight * number;
        second += weight * number * number;
    }
    let middle = first / total;
    Posterior {
        middle,
        sd: (second / total - middle * middle).max(0.0).sqrt(),
        lo,
        hi,
    }
}

/// A record for judging single moments: noise that is louder elsewhere than under the lines is
/// brought down to that.
pub(crate) struct Quiet {
    /// The record, by the share that the least density under a line is of the density, where less
    /// than 1; zero where not usable.
    pub(crate) values: Series,
    /// Variance of a sample of white noise of that least density.
    pub(crate) variance: f64,
}

/// Index of a loss close to the edge of a block: the lines are known from the whole record, and
/// each sample speaks for the phase ahead of the loss or behind it. Between moments `t` and `t + 1`
/// lie
///
/// ```text
/// x' C^-1 (a - b) - (a' C^-1 a - b' C^-1 b) / 2
/// ```
///
/// with `a` and `b` the lines ahead and behind at sample `t`, and `C^-1` one number a line.
pub(crate) fn zoom(
    blocks: &Blocks,
    quiet: &Quiet,
    lines: &[Line],
    turned: &[Turned],
    best: Best,
) -> Posterior {
    let from = best.place.saturating_sub(ZOOM) * blocks.len;
    let to = ((best.place + ZOOM) * blocks.len).min(quiet.values.len());
    // The sum of the lines, and the same with each by the root of its share of the information.
    let at = |moment: usize| -> (f64, f64) {
        let (mut sum, mut weighed) = (0.0, 0.0);
        for (line, turned) in lines.iter().zip(turned) {
            let cycles = line.cycles(turned.offset, blocks.len);
            let turn = TAU * (moment as f64 * cycles).fract();
            let value = (turned.amplitude * Complex64::from_polar(1.0, turn)).re;
            // 4 rate S of the demodulated record; the samples' own variance is rate S.
            let share = (4.0 * quiet.variance / line.seen.noise).min(1.0);
            sum += value;
            weighed += share.sqrt() * value;
        }
        (sum, weighed)
    };
    let mut gain = 0.0;
    let gains: Vec<f64> = (from..to)
        .map(|index| {
            let here = gain;
            let value = quiet.values[index];
            // What is not usable is exactly zero, and speaks for neither.
            if value != 0.0 {
                let (ahead, behind) = (at(index), at(index + best.samples));
                let own = 0.5 * (behind.1.powi(2) - ahead.1.powi(2));
                gain += (value * (ahead.0 - behind.0) + own) / quiet.variance;
            }
            here
        })
        .collect();
    let found = posterior(&gains.iter().copied());
    let from = from as f64;
    Posterior {
        middle: from + found.middle,
        lo: from + found.lo,
        hi: from + found.hi,
        // A whole number, by its rounding.
        sd: found.sd.max(12f64.sqrt().recip()),
    }
}

/// Gain on every second block of what was fitted to the others.
pub(crate) fn held(lines: &[Line], longest: usize) -> f64 {
    let seen: Vec<Line> = lines
        .iter()
        .map(|line| {
            let half = line.seen.every_second(0);
            let (offset, gain) = half.best_offset(line.offset, LINE_REACH, None);
            let seen = half;
            Line { seen, offset, gain }
        })
        .collect();
    let tables = Tables::new(&seen, longest);
    let candidates = tables.candidates();
    let Some(best) = candidates.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)) else {
        return 0.0;
    };
    let turned = fitted(&seen, best.place as f64, best.samples);
    lines
        .iter()
        .zip(&seen)
        .zip(&turned)
        .map(|((line, seen), turned)| {
            let other = line.seen.every_second(1);
            let (steady, _) = seen.seen.line(seen.offset, None);
            other.log_likelihood(turned.amplitude, turned.offset, Some(turned.turn))
                - other.log_likelihood(steady, seen.offset, None)
        })
        .sum()
}
