//! When samples were lost: what the likelihoods of all moments leave open, by blocks or sample by sample.

use std::ops::Range;

use super::demodulate::Blocks;
use super::line::{Line, Turned};
use crate::fft::phasor::Phasor;
use crate::fft::ring::Series;

/// Blocks on either side of the best in which the moment is looked for sample by sample: a choice.
const ZOOM: usize = 6;

/// A moment and a number of samples.
#[derive(Clone, Copy)]
pub(crate) struct Best {
    /// First block after the loss.
    pub(crate) place: usize,
    pub(crate) samples: usize,
    pub(crate) gain: f64,
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
pub(crate) struct Quiet<'a> {
    /// The record as it is, with all its lines.
    pub(crate) whole: &'a [f64],
    /// The record, by the share that the least density under a line is of the density, where less
    /// than 1; zero where not usable.
    pub(crate) values: Series,
    /// Variance of a sample of white noise of that least density.
    pub(crate) variance: f64,
}

/// All lines together at a sample.
#[derive(Clone, Copy, Default)]
struct Course {
    /// Their sum.
    sum: f64,
    /// The same, each by the root of its share of the information.
    weighed: f64,
}

/// The lines as they run on from their beginning, at these samples.
fn courses(
    blocks: &Blocks,
    quiet: &Quiet<'_>,
    lines: &[Line],
    turned: &[Turned],
    samples: Range<usize>,
) -> Vec<Course> {
    let mut courses = vec![Course::default(); samples.len()];
    for (line, turned) in lines.iter().zip(turned) {
        // 4 rate S of the demodulated record; the samples' own variance is rate S.
        let share = (4.0 * quiet.variance / line.seen.noise).min(1.0).sqrt();
        let phasor = Phasor::new(line.cycles(turned.offset, blocks.len));
        phasor.zip(
            samples.start,
            &mut courses,
            turned.amplitude,
            |course, line| {
                course.sum += line.re;
                course.weighed += share * line.re;
            },
        );
    }
    courses
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
    quiet: &Quiet<'_>,
    lines: &[Line],
    turned: &[Turned],
    best: Best,
) -> Posterior {
    let from = best.place.saturating_sub(ZOOM) * blocks.len;
    let to = ((best.place + ZOOM) * blocks.len).min(quiet.values.len());
    let courses = courses(blocks, quiet, lines, turned, from..to + best.samples);
    let mut gain = 0.0;
    let shifted = courses.iter().zip(courses.iter().skip(best.samples));
    let values = quiet.values[from..to].iter();
    let gains: Vec<f64> = values
        .zip(shifted)
        .map(|(value, (ahead, behind))| {
            let here = gain;
            // What is not usable is exactly zero, and speaks for neither.
            if *value != 0.0 {
                let own = 0.5 * (behind.weighed.powi(2) - ahead.weighed.powi(2));
                gain += (value * (ahead.sum - behind.sum) + own) / quiet.variance;
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
