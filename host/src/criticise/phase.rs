//! Samples lost without a trace: every line's phase jumps at one moment, by what it would have
//! turned in the samples that are missing.
//!
//! A line of frequency `f` runs on by `2 pi f d / rate` where `d` samples are lost. All lines are
//! looked at together for one moment `t` and one whole number `d`; each has its own amplitude,
//! phase and small offset in frequency, with the loss as without it. `G(t, d)` is the gain in
//! log-likelihood over steady lines (S. M. Kay, *Fundamentals of Statistical Signal Processing* II,
//! 1998, ch. 6).
//!
//! **Level.** The likelihood ratio averaged over all `n` moments and lengths tried, each with the
//! same weight, `m = (1/n) sum e^G`, has mean 1 without a loss, so that `1 / m` bounds the
//! probability of as much (A. A. Markov's inequality). It counts the trials by itself; amplitudes
//! and offsets are fitted on both sides of the ratio.
//!
//! **Look-alikes.** One line that changes its phase by itself: without the line that speaks loudest
//! for the loss the others must still be for it, over the lengths which that one leaves open. Lines
//! that wander or beat: the loss must explain nearly all that steady lines leave.

use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

use super::axis::AxisState;
use super::demodulate::{Blocks, Demodulated, Turn};
use super::mend::Wave;

/// Blocks that a record is cut into, at most and at least.
const BLOCKS: usize = 512;
const FEWEST_BLOCKS: usize = 64;

/// Cycles of a line in a block, at least: fewer are not told from drift.
const CYCLES: f64 = 8.0;

/// Share of the record at each end in which no loss is looked for.
const MARGIN: f64 = 0.02;

/// Samples lost that are looked for, at most: as many as the slowest line has to a cycle, but
/// within these.
const LONGEST: [f64; 2] = [64.0, 256.0];

/// Frequencies closer than this, in cycles a record, are one line that a jump has split.
const SPLIT: f64 = 12.0;

/// Frequencies farther apart are no line.
const WIDEST: f64 = 100.0;

/// How far from a steady line's best frequency the line may be, cycles a record.
const REACH: f64 = 3.0;

/// Log-likelihood that a line gains, at least, to be one.
const LEAST_LINE: f64 = 8.0;

/// Lines that are looked at; the strongest if there are more.
const MOST_LINES: usize = 16;

/// Logarithm of the odds that the lines but the loudest must give, 20 to 1.
const ODDS: f64 = 3.0;

/// Log-likelihood within which a length or a moment is as good as the best: 95 %.
const AS_GOOD: f64 = 2.0;

/// Error of the tables, at most, as a share of the gain: they know a moment by its block alone.
const TABLE_SHARE: f64 = 0.1;

/// Cycles a record on either side of a line where the loss must explain what is there.
const NEAR: usize = 16;

/// Largest share of what a loss explains that may remain unexplained.
const LEFT_SHARE: f64 = 0.1;

/// Samples lost without a trace.
#[derive(Debug, Clone, PartialEq)]
pub struct Loss {
    /// Index of the first sample after the loss.
    pub index: usize,
    /// Standard deviation of it, samples.
    pub index_sd: f64,
    /// Samples lost. Numbers that differ by a common period of all lines cannot be told apart:
    /// the smallest.
    pub samples: u32,
    /// 95 % interval of that number, half a sample beyond the whole numbers that it holds.
    pub samples_lo: f64,
    /// Its upper end.
    pub samples_hi: f64,
    /// Gain in log-likelihood over steady lines.
    pub nats: f64,
    /// The same on blocks that nothing was fitted to.
    pub held_nats: f64,
    /// Bound for the probability of as much in steady lines, trials counted.
    pub p_value: f64,
    /// The lines, steady once the loss is taken into account.
    pub lines: Vec<SteadyLine>,
}

/// A line: `cosine cos(2 pi cycles n) + sine sin(2 pi cycles n)` for sample `n` ahead of the loss,
/// with `n + samples` in place of `n` from [`Loss::index`] on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyLine {
    /// Frequency, cycles a sample.
    pub cycles: f64,
    /// Size of the cosine.
    pub cosine: f64,
    /// Size of the sine.
    pub sine: f64,
}

impl Loss {
    /// The lines as [`Wave::take_out`] takes them out.
    pub fn waves(&self) -> impl Iterator<Item = Wave> + '_ {
        self.lines.iter().map(|line| Wave::Line {
            cycles: line.cycles,
            cosine: line.cosine,
            sine: line.sine,
            lost: Some((self.index, self.samples)),
        })
    }
}

/// Looks for samples lost in an axis at a family-wise `level`, by lines near `lines_hz`; twins into
/// which a jump splits a line count as one. Lines that were taken out of the record already are
/// put back for the look, and are among the result's. `None` without two lines.
pub fn lost_samples(axis: &AxisState, lines_hz: &[f64], level: f64) -> Option<Loss> {
    let mut values = axis.filled.clone();
    let near = SPLIT * axis.rate_hz / values.len() as f64;
    for wave in &axis.mended.waves {
        let Wave::Line {
            cycles,
            cosine,
            sine,
            lost,
        } = *wave
        else {
            continue;
        };
        let f_hz = cycles * axis.rate_hz;
        if lines_hz.iter().any(|line| (line - f_hz).abs() < near) {
            let (cosine, sine) = (-cosine, -sine);
            let back = Wave::Line {
                cycles,
                cosine,
                sine,
                lost,
            };
            back.take_out(&mut values);
        }
    }
    let lines: Vec<f64> = lines_hz.iter().map(|f_hz| f_hz / axis.rate_hz).collect();
    search(&values, &lines, level, |index| axis.usable(index))
}

/// [`lost_samples`] in a plain series: `rough` frequencies in cycles a sample.
fn search(
    values: &[f64],
    rough: &[f64],
    level: f64,
    usable: impl Fn(usize) -> bool,
) -> Option<Loss> {
    let mut groups = merged(rough, values.len());
    // The slowest line decides how fine the blocks are; what is slower than any allows is left.
    groups.retain(|group| {
        group.cycles * values.len() as f64 >= CYCLES * FEWEST_BLOCKS as f64 && group.cycles < 0.5
    });
    let slowest = groups.first()?.cycles;
    let count = ((slowest * values.len() as f64 / CYCLES) as usize).min(BLOCKS);
    let blocks = Blocks::new(values, count, usable);
    let mut lines: Vec<Line> = groups
        .iter()
        .map(|group| {
            let seen = blocks.at(group.cycles);
            let (offset, gain) = seen.best_offset(0.0, 0.5 * group.width + 2.0 * REACH, None);
            Line { seen, offset, gain }
        })
        .filter(|line| line.gain > LEAST_LINE)
        .collect();
    lines.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    lines.truncate(MOST_LINES);
    if lines.len() < 2 {
        return None;
    }
    let longest = (1.0 / slowest).clamp(LONGEST[0], LONGEST[1]) as usize;

    let tables = Tables::new(&lines, longest);
    let table_highest = tables.sum.iter().copied().fold(f64::MIN, f64::max);
    let found: Vec<Found> = tables
        .candidates()
        .into_iter()
        .map(|best| Found::new(&blocks, &lines, &tables, best))
        .collect();
    let (chosen, samples_lo, samples_hi) = smallest_of_the_best(&found)?;
    let Found {
        best,
        index,
        index_sd,
        ref turned,
        ..
    } = found[chosen];

    let gains: Vec<f64> = turned
        .iter()
        .zip(&lines)
        .map(|(turned, line)| turned.gain - line.gain)
        .collect();
    let nats: f64 = gains.iter().sum();
    // The tables rest on blocks and on a parabola in frequency; the last word is the fit's.
    let p_value = (table_highest - tables.mean_ratio() - nats).exp().min(1.0);
    let loudest = gains
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(b.1))
        .map(|(line, _)| line)?;
    let others = tables.others(loudest, best.place);
    let left: f64 = turned
        .iter()
        .zip(&lines)
        .map(|(turned, line)| line.seen.left_over(turned.offset, Some(turned.turn), NEAR))
        .sum();
    // Noise leaves as many as there are ordinates, with that variance.
    let spread = ((2 * NEAR + 1) as f64 * lines.len() as f64).sqrt();
    let explained = left < LEFT_SHARE * nats + 3.0 * spread;
    if !(p_value < level && others > ODDS && explained) {
        return None;
    }
    Some(Loss {
        index,
        index_sd,
        samples: best.samples as u32,
        samples_lo,
        samples_hi,
        nats,
        held_nats: held(&lines, longest),
        p_value,
        lines: turned
            .iter()
            .zip(&lines)
            .map(|(turned, line)| SteadyLine {
                cycles: line.cycles(turned.offset, blocks.len),
                cosine: turned.amplitude.re,
                sine: -turned.amplitude.im,
            })
            .collect(),
    })
}

/// A length looked at closely.
struct Found {
    best: Best,
    index: usize,
    index_sd: f64,
    turned: Vec<Turned>,
    /// Gain in log-likelihood over no lines at all.
    gain: f64,
}

impl Found {
    fn new(blocks: &Blocks, lines: &[Line], tables: &Tables, best: Best) -> Self {
        let (middle, sd) = tables.moment(best.samples);
        let (mut index, mut index_sd, mut place) = (
            (middle * blocks.len as f64).round() as usize,
            sd * blocks.len as f64,
            best.place as f64,
        );
        let mut turned = fitted(lines, place, best.samples);
        if sd < 1.0 {
            (index, index_sd) = zoom(blocks, lines, &turned, best);
            place = index as f64 / blocks.len as f64;
            turned = fitted(lines, place, best.samples);
        }
        Self {
            best,
            index,
            index_sd,
            gain: turned.iter().map(|turned| turned.gain).sum(),
            turned,
        }
    }
}

/// Which of the lengths, ascending, to name: the best of the smallest that are as good and adjoin
/// one another; with the interval that these make.
fn smallest_of_the_best(found: &[Found]) -> Option<(usize, f64, f64)> {
    let highest = found
        .iter()
        .map(|one| one.gain)
        .fold(f64::NEG_INFINITY, f64::max);
    let good: Vec<usize> = (0..found.len())
        .filter(|&one| found[one].gain > highest - AS_GOOD)
        .collect();
    let samples = |one: usize| found[one].best.samples;
    let run = good
        .chunk_by(|&a, &b| samples(b) == samples(a) + 1)
        .next()?;
    let chosen = run
        .iter()
        .copied()
        .max_by(|&a, &b| found[a].gain.total_cmp(&found[b].gain))?;
    Some((
        chosen,
        samples(run[0]) as f64 - 0.5,
        samples(run[run.len() - 1]) as f64 + 0.5,
    ))
}

/// Frequencies that are one line, ascending.
struct Group {
    /// Middle, cycles a sample.
    cycles: f64,
    /// Distance of the outermost, cycles a record.
    width: f64,
}

fn merged(rough: &[f64], len: usize) -> Vec<Group> {
    let mut rough = rough.to_vec();
    rough.sort_by(f64::total_cmp);
    rough
        .chunk_by(|a, b| (b - a) * (len as f64) < SPLIT)
        .map(|twins| {
            let (first, last) = (twins[0], twins[twins.len() - 1]);
            Group {
                cycles: 0.5 * (first + last),
                width: (last - first) * len as f64,
            }
        })
        .filter(|group| group.width < WIDEST)
        .collect()
}

/// A line and its best steady fit.
struct Line {
    seen: Demodulated,
    /// Cycles a record from where it is looked at.
    offset: f64,
    /// Gain in log-likelihood over no line.
    gain: f64,
}

impl Line {
    fn cycles(&self, offset: f64, block: usize) -> f64 {
        self.seen.cycles + offset / (self.seen.sums.len() * block) as f64
    }
}

/// A line with a jump of phase.
struct Turned {
    turn: Turn,
    offset: f64,
    amplitude: Complex64,
    gain: f64,
}

/// The lines with `samples` lost at `place`, in blocks.
fn fitted(lines: &[Line], place: f64, samples: usize) -> Vec<Turned> {
    lines
        .iter()
        .map(|line| {
            let turn = Turn {
                place,
                angle: TAU * line.seen.cycles * samples as f64,
            };
            let (offset, _) = line.seen.best_offset(line.offset, REACH, Some(turn));
            let (amplitude, gain) = line.seen.line(offset, Some(turn));
            Turned {
                turn,
                offset,
                amplitude,
                gain,
            }
        })
        .collect()
}

/// A moment and a number of samples.
#[derive(Clone, Copy)]
struct Best {
    /// First block after the loss.
    place: usize,
    samples: usize,
    gain: f64,
}

/// Gains over steady lines, of each line, for all moments and lengths.
struct Tables {
    longest: usize,
    /// First block that a loss is looked for ahead of.
    first: usize,
    /// By line, then moment, then length.
    each: Vec<Vec<f64>>,
    sum: Vec<f64>,
}

impl Tables {
    fn new(lines: &[Line], longest: usize) -> Self {
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
            each,
            sum,
        }
    }

    /// The best moment for each length that may be the best, ascending.
    fn candidates(&self) -> Vec<Best> {
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
    fn mean_ratio(&self) -> f64 {
        log_sum(&self.sum) - (self.sum.len() as f64).ln()
    }

    /// Middle and standard deviation of the moment, in blocks, all moments alike beforehand.
    fn moment(&self, samples: usize) -> (f64, f64) {
        let gains = self.sum[samples - 1..].iter().step_by(self.longest);
        let (middle, sd) = posterior(gains.copied());
        (self.first as f64 + middle, sd)
    }

    /// Logarithm of the odds that the other lines give at a moment, over the lengths that one line
    /// by itself leaves open, each by what it is worth to that one.
    fn others(&self, line: usize, place: usize) -> f64 {
        let from = (place - self.first) * self.longest;
        let moment = from..from + self.longest;
        log_sum(&self.sum[moment.clone()]) - log_sum(&self.each[line][moment])
    }
}

/// Logarithm of the sum of exponentials.
fn log_sum(gains: &[f64]) -> f64 {
    let highest = gains.iter().copied().fold(f64::MIN, f64::max);
    let sum: f64 = gains.iter().map(|gain| (gain - highest).exp()).sum();
    highest + sum.ln()
}

/// Gains of one line over a steady one for losses of 1 to `longest` samples ahead of each block of
/// `places`, the frequency fitted: the best of a grid, and from there one step of Newton's.
fn gains(line: &Line, places: std::ops::Range<usize>, longest: usize) -> Vec<f64> {
    /// Cycles a record between points of the grid.
    const STEP: f64 = 0.25;
    let seen = &line.seen;
    let count = seen.sums.len();
    let norm = seen.noise * seen.weights.iter().sum::<f64>();
    // Running sums of y e^(-j v w), of v and of v^2 times that, v the angle a unit of offset.
    let running: Vec<Vec<[Complex64; 3]>> = (-(REACH / STEP) as i32..=(REACH / STEP) as i32)
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

/// Middle and standard deviation of a whole number by its log-likelihoods from 0 on.
fn posterior(gains: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let highest = gains.clone().fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
    for (number, gain) in gains.enumerate() {
        let (weight, number) = ((gain - highest).exp(), number as f64);
        sum += weight;
        first += weight * number;
        second += weight * number * number;
    }
    let middle = first / sum;
    (middle, (second / sum - middle * middle).max(0.0).sqrt())
}

/// Index and standard deviation of a loss close to the edge of a block: the lines are known from
/// the whole record, and each sample speaks for the phase ahead of the loss or behind it.
fn zoom(blocks: &Blocks, lines: &[Line], turned: &[Turned], best: Best) -> (usize, f64) {
    let from = best.place.saturating_sub(4) * blocks.len;
    let to = ((best.place + 4) * blocks.len).min(blocks.values.len());
    // One density for all lines, each by what it contributes.
    let (mut power, mut weight) = (0.0, 0.0);
    for (line, turned) in lines.iter().zip(turned) {
        power += turned.amplitude.norm_sqr();
        weight += turned.amplitude.norm_sqr() / line.seen.noise;
    }
    // 4 rate S of the demodulated record; the samples' own variance is rate S.
    let variance = 0.25 * power / weight;
    let at = |moment: usize| -> f64 {
        let one = |(line, turned): (&Line, &Turned)| {
            let cycles = line.cycles(turned.offset, blocks.len);
            let turn = TAU * (moment as f64 * cycles).fract();
            (turned.amplitude * Complex64::from_polar(1.0, turn)).re
        };
        lines.iter().zip(turned).map(one).sum()
    };
    let mut gain = 0.0;
    let gains: Vec<f64> = (from..to)
        .map(|index| {
            let here = gain;
            let value = blocks.values[index];
            // What is not usable is exactly zero, and speaks for neither.
            if value != 0.0 {
                let (ahead, behind) = (at(index), at(index + best.samples));
                gain += ((value - behind).powi(2) - (value - ahead).powi(2)) / (2.0 * variance);
            }
            here
        })
        .collect();
    let (middle, sd) = posterior(gains.iter().copied());
    // A whole number, by its rounding.
    (from + middle.round() as usize, sd.max(12f64.sqrt().recip()))
}

/// Gain on every second block of what was fitted to the others.
fn held(lines: &[Line], longest: usize) -> f64 {
    let seen: Vec<Line> = lines
        .iter()
        .map(|line| {
            let half = line.seen.every_second(0);
            let (offset, gain) = half.best_offset(line.offset, REACH, None);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Seed;
    use crate::simulate::Gaussian;

    const LENGTH: usize = 60_000;
    const RATE_HZ: f64 = 2000.0;

    /// Harmonics of `base_hz` in white noise of deviation 1, each with the gain in log-likelihood
    /// given for it, `samples` lost ahead of sample `at`.
    fn hum(
        seed: u64,
        base_hz: f64,
        harmonics: &[(f64, f64)],
        at: usize,
        samples: usize,
    ) -> Vec<f64> {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut values: Vec<f64> = (0..LENGTH).map(|_| noise.draw()).collect();
        for (number, nats) in harmonics {
            // A^2 N / (4 sigma^2) nats.
            let amplitude = (4.0 * nats / LENGTH as f64).sqrt();
            let phase = TAU * noise.draw();
            for (index, value) in values.iter_mut().enumerate() {
                let moment = index + if index < at { 0 } else { samples };
                let turn = TAU * (number * base_hz / RATE_HZ * moment as f64).fract();
                *value += amplitude * (turn + phase).cos();
            }
        }
        values
    }

    /// Frequencies in cycles a sample, each off by as much as a jump splits a line.
    fn rough(base_hz: f64, harmonics: &[(f64, f64)]) -> Vec<f64> {
        harmonics
            .iter()
            .flat_map(|(number, _)| {
                let cycles = number * base_hz / RATE_HZ;
                [cycles - 0.8 / LENGTH as f64, cycles + 1.1 / LENGTH as f64]
            })
            .collect()
    }

    fn look(values: &[f64], rough: &[f64], level: f64) -> Option<Loss> {
        search(values, rough, level, |_| true)
    }

    const HARMONICS: [(f64, f64); 3] = [(1.0, 200.0), (2.0, 120.0), (3.0, 80.0)];

    /// Where and how much is lost in the record of a seed.
    fn drawn(seed: u64) -> (usize, usize) {
        let mut random = Gaussian::new(Seed { seed, stream: 1 }, 1.0);
        let place = 0.5 + 0.25 * random.draw().tanh();
        let samples = 4 + (29.0 * random.draw().abs().fract()) as usize;
        ((place * LENGTH as f64) as usize, samples.min(26))
    }

    #[test]
    fn a_loss_is_found_and_measured() {
        let (mut squares, mut inside, mut held) = (Vec::new(), 0, 0);
        for seed in 0..16 {
            let base_hz = if seed % 2 == 0 { 50.03 } else { 59.98 };
            let (at, samples) = drawn(seed);
            let values = hum(seed, base_hz, &HARMONICS, at, samples);
            let loss = look(&values, &rough(base_hz, &HARMONICS), 1e-4)
                .unwrap_or_else(|| panic!("seed {seed}: {samples} at {at}"));
            let truth = samples as f64;
            inside += i32::from(loss.samples_lo < truth && truth < loss.samples_hi);
            held += i32::from(loss.held_nats > 0.0);
            squares.push(((loss.index as f64 - at as f64) / loss.index_sd).powi(2));
            assert!(
                (f64::from(loss.samples) - truth).abs() <= 3.0,
                "seed {seed}"
            );
            // With the lines out, white noise of variance 1 is left: 4 sigma of its mean square.
            let mut left = values;
            loss.waves().for_each(|wave| wave.take_out(&mut left));
            let power = left.iter().map(|v| v * v).sum::<f64>() / LENGTH as f64;
            assert!(
                (power - 1.0).abs() < 4.0 * (2.0 / LENGTH as f64).sqrt(),
                "seed {seed}: {power}"
            );
        }
        // 95 % of 16: fewer than 12 have a chance of 1e-4.
        assert!(inside >= 12, "{inside} of 16");
        assert_eq!(held, 16);
        // The moment's posterior has exponential tails, kurtosis about 6: sd of a mean square
        // of 16 values is sqrt(5/16); 4 of these.
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        assert!(mean < 1.0 + 4.0 * (5.0f64 / 16.0).sqrt(), "{mean}");
    }

    #[test]
    fn steady_lines_keep_the_level() {
        // Markov: 1/m < 0.1 in at most a tenth of the records. In 40, 4 and 4 sigma: 11.
        let mut low = 0;
        for seed in 100..140 {
            let values = hum(seed, 50.03, &HARMONICS, 0, 0);
            assert_eq!(
                look(&values, &rough(50.03, &HARMONICS), 0.1),
                None,
                "seed {seed}"
            );
            let blocks = Blocks::new(&values, BLOCKS, |_| true);
            let lines: Vec<Line> = HARMONICS
                .iter()
                .map(|(number, _)| {
                    let seen = blocks.at(number * 50.03 / RATE_HZ);
                    let (offset, gain) = seen.best_offset(0.0, REACH, None);
                    Line { seen, offset, gain }
                })
                .collect();
            low += i32::from(Tables::new(&lines, 64).mean_ratio() > 10f64.ln());
        }
        assert!(low < 11, "{low} of 40, seeds 100..140");
    }

    #[test]
    fn look_alikes_are_none() {
        for seed in 200..206 {
            let lines = rough(50.03, &HARMONICS);
            // The base jumps by itself, the others go on.
            let mut values = hum(seed, 50.03, &HARMONICS[..1], 30_000, 9);
            let rest = hum(seed + 1000, 50.03, &HARMONICS[1..], 0, 0);
            values.iter_mut().zip(&rest).for_each(|(v, r)| *v += r);
            assert_eq!(look(&values, &lines, 1e-3), None, "alone, seed {seed}");
            // The mains' phase wanders, a random walk of 2 radians over the record.
            let mut random = Gaussian::new(Seed { seed, stream: 3 }, 1.0);
            let mut phase = 0.0;
            let mut values = hum(seed, 50.03, &[], 0, 0);
            for (index, value) in values.iter_mut().enumerate() {
                phase += 2.0 * random.draw() / (LENGTH as f64).sqrt();
                let turn = TAU * (50.03 / RATE_HZ * index as f64).fract() + phase;
                *value += 0.2 * turn.cos() + 0.15 * (2.0 * turn).cos() + 0.1 * (3.0 * turn).cos();
            }
            assert_eq!(look(&values, &lines, 1e-3), None, "wander, seed {seed}");
            // Two hums that beat.
            let shifted = 50.03 + 1.7 * RATE_HZ / LENGTH as f64;
            let mut values = hum(seed, 50.03, &HARMONICS, 0, 0);
            let other = hum(seed + 2000, shifted, &HARMONICS, 0, 0);
            values.iter_mut().zip(&other).for_each(|(v, o)| *v += o);
            assert_eq!(look(&values, &lines, 1e-3), None, "beat, seed {seed}");
            // One line alone.
            let values = hum(seed, 50.03, &HARMONICS[..1], 30_000, 9);
            assert_eq!(look(&values, &lines[..2], 1e-3), None, "one, seed {seed}");
        }
    }
}
