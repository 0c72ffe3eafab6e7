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

mod ratio;
#[cfg(test)]
mod tests;

use super::axis::AxisState;
use super::demodulate::Blocks;
use super::mend::Wave;

use ratio::{Best, Line, Tables, Turned, fitted, held, zoom};

/// Blocks that a record is cut into, at most and at least.
const BLOCKS: usize = 512;
const FEWEST_BLOCKS: usize = 64;

/// Cycles of a line in a block, at least: fewer are not told from drift.
const CYCLES: f64 = 8.0;

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
