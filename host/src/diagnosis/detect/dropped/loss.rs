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

use std::borrow::Cow;
use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::wave::Wave;
use crate::spectrum::Line as Peak;

use super::demodulate::Blocks;
use super::peaks::{self, Place, SPLIT};
use super::ratio::{
    self, AS_GOOD, Best, LINE_REACH, Line, Posterior, Quiet, Tables, Turned, fitted, held, zoom,
};

/// Blocks that a record is cut into, at most and at least. The tables hold every block times every
/// number lost, so that more cost time; a moment is followed to the sample afterwards. Of fewer the
/// noise would be the median of less than 48 ordinates. Both are choices.
const BLOCKS: usize = 512;
const FEWEST_BLOCKS: usize = 64;

/// Cycles of a line in a block, at least: a choice. Fewer are not resolved from drift.
const CYCLES: f64 = 8.0;

/// Samples lost that are looked for, at most: as many as the slowest line has to a cycle, but
/// within these, which are choices: the time grows with the number.
const LONGEST: [f64; 2] = [64.0, 256.0];

/// Log-likelihood that a line gains, at least, to be one: at a given frequency noise does as well
/// once in 3000 times.
const LEAST_LINE: f64 = 8.0;

/// Lines that are looked at, at most, the strongest: a choice, for each costs a table.
const MOST_LINES: usize = 16;

/// Logarithm of the odds that the lines but the loudest must give, 20 to 1.
const ODDS: f64 = 3.0;

/// Cycles a record on either side of a line where the loss must explain what is there: a choice.
const AROUND_LINE: usize = 16;

/// Times that the lines are freed of one another: a choice. The second sees the noise that the
/// first had lowered.
const CLEANINGS: usize = 2;

/// Largest share of what a loss explains that may remain unexplained: a choice.
const LEFT_SHARE: f64 = 0.1;

/// Samples lost without a trace.
#[derive(Debug, Clone, PartialEq)]
pub struct Loss {
    /// Index of the first sample after the loss.
    pub index: usize,
    /// Standard deviation of it, samples.
    pub index_sd: f64,
    /// Lower end of the index' 95 % interval, samples.
    pub index_lo: f64,
    /// Upper end of that interval, samples.
    pub index_hi: f64,
    /// Samples lost. Numbers that differ by a common period of all lines cannot be distinguished:
    /// the smallest.
    pub samples: u32,
    /// 95 % interval of that number, half a sample beyond the whole numbers that it holds.
    pub samples_lo: f64,
    /// Upper end of that interval.
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
    /// Standard deviation of the frequency for not knowing how many samples are lost.
    pub cycles_sd: f64,
    /// The same of the amplitude.
    pub amplitude_sd: f64,
    /// Gain in log-likelihood over no line: its power over the noise.
    pub nats: f64,
}

impl SteadyLine {
    /// As a search of the whole record, loss repaired, would report it.
    pub fn peak(&self, rate_hz: f64, duration_s: f64) -> Peak {
        Peak {
            frequency_hz: self.cycles * rate_hz,
            // Cramer-Rao bound of a single tone (Rife and Boorstyn 1974, eq. 16).
            frequency_sd_hz: ((1.5 / (PI * PI * self.nats)).sqrt() / duration_s)
                .hypot(self.cycles_sd * rate_hz),
            amplitude: self.cosine.hypot(self.sine),
            ratio: self.nats,
            false_alarm: self.false_alarm(),
        }
    }

    /// Probability of as much at one of the places tried: a cycle a record is one trial, and
    /// Rice's formula adds a factor of a few.
    fn false_alarm(&self) -> f64 {
        let trials = f64::from(peaks::HARMONICS) * 4.0 * LINE_REACH * (PI * self.nats / 3.0).sqrt();
        (trials * (-self.nats).exp()).min(1.0)
    }
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

/// Looks for samples lost in an axis at a family-wise `level`, by the lines `found` and what else
/// there is at multiples of a mains frequency among them; the side lobes into which a jump splits
/// a line count as one with it. Lines that were taken out of the record already are put back for
/// the look, and are among the result's. `None` without two lines.
pub fn lost_samples(axis: &AxisState, found: &[Peak], level: f64) -> Option<Loss> {
    let mut values = Cow::from(axis.filled.as_slice());
    let near = SPLIT * axis.rate_hz / values.len() as f64;
    for wave in axis.residual.waves() {
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
        if found
            .iter()
            .any(|line| (line.frequency_hz - f_hz).abs() < near)
        {
            let (cosine, sine) = (-cosine, -sine);
            let back = Wave::Line {
                cycles,
                cosine,
                sine,
                lost,
            };
            back.take_out(values.to_mut());
        }
    }
    let peaks = peaks::merged(found, axis.rate_hz, values.len());
    let places = peaks::with_harmonics(peaks, axis.rate_hz, values.len());
    if places.len() < 2 {
        return None;
    }
    let usable = |index: usize| axis.usable(index);
    let quiet = quiet(axis, &places);
    search(&values, &quiet, &places, level, usable)
}

/// The record with loud noise brought down to what is under the lines.
fn quiet(axis: &AxisState, places: &[Place]) -> Quiet {
    let least = places
        .iter()
        .map(|place| axis.density(place.cycles * axis.rate_hz))
        .fold(f64::INFINITY, f64::min);
    let seen = axis.whitened();
    let (whole, density) = (&seen.transform, &seen.density);
    let mut values = whole.filtered(|k| Complex64::new((least / density[k]).min(1.0), 0.0));
    for (index, value) in values.iter_mut().enumerate() {
        if !axis.usable(index) {
            *value = 0.0;
        }
    }
    Quiet {
        values,
        variance: least * axis.rate_hz,
    }
}

/// [`lost_samples`] in a plain series.
fn search(
    values: &[f64],
    quiet: &Quiet,
    places: &[Place],
    level: f64,
    usable: impl Fn(usize) -> bool,
) -> Option<Loss> {
    // The slowest line decides how fine the blocks are; what is slower than any allows is left.
    let places: Vec<&Place> = places
        .iter()
        .filter(|place| {
            place.cycles * values.len() as f64 >= CYCLES * FEWEST_BLOCKS as f64
                && place.cycles < 0.5
        })
        .collect();
    let slowest = places
        .iter()
        .map(|place| place.cycles)
        .min_by(f64::total_cmp)?;
    let count = ((slowest * values.len() as f64 / CYCLES) as usize).min(BLOCKS);
    let blocks = Blocks::new(values, count, usable);
    let mut lines = separate(&blocks, &places, values.len());
    if lines.len() < 2 {
        return None;
    }
    let longest = (1.0 / slowest).clamp(LONGEST[0], LONGEST[1]) as usize;
    let (mut tables, mut found) = looked(&blocks, quiet, &lines, longest);
    // A strong line that jumps is noise to the others and, by its skirts, to itself: each is looked
    // at again without the rest, against the noise that all of them leave.
    for _ in 0..CLEANINGS {
        let (chosen, ..) = smallest_of_the_best(&found)?;
        if found[chosen].nats(&lines) < LEAST_LINE {
            return None;
        }
        let chosen = &found[chosen];
        lines = ratio::cleaned(&blocks, &lines, &chosen.turned, chosen.index());
        (tables, found) = looked(&blocks, quiet, &lines, longest);
    }
    let case = Case {
        blocks: &blocks,
        lines: &lines,
        longest,
        tables: &tables,
        found: &found,
    };
    case.judged(level)
}

/// Lines at these places that are strong enough and stand by themselves, the strongest first; the record has
/// `length` samples.
fn separate(blocks: &Blocks, places: &[&Place], length: usize) -> Vec<Line> {
    let lines = places.iter().map(|place| {
        Line::new(
            blocks.at(place.cycles),
            0.5 * place.width + 2.0 * LINE_REACH,
        )
    });
    let mut lines: Vec<Line> = lines.filter(|line| line.gain > LEAST_LINE).collect();
    lines.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut separate: Vec<Line> = Vec::new();
    for line in lines {
        let place = |line: &Line| line.cycles(line.offset, blocks.len) * length as f64;
        let alone = |other: &Line| (place(other) - place(&line)).abs() > AROUND_LINE as f64;
        if separate.iter().all(alone) {
            separate.push(line);
        }
    }
    separate.truncate(MOST_LINES);
    separate
}

/// What speaks for a loss.
struct Case<'a> {
    blocks: &'a Blocks,
    lines: &'a [Line],
    /// Longest loss that is looked for, samples.
    longest: usize,
    tables: &'a Tables,
    found: &'a [Found],
}

impl Case<'_> {
    /// The loss, if it is significant at a `level` and no look-alike.
    fn judged(&self, level: f64) -> Option<Loss> {
        let (chosen, samples_lo, samples_hi) = smallest_of_the_best(self.found)?;
        let Found {
            best,
            moment,
            ref turned,
            ..
        } = self.found[chosen];
        let pairs = || turned.iter().zip(self.lines);
        let gains: Vec<f64> = pairs()
            .map(|(turned, line)| turned.gain - line.gain)
            .collect();
        let nats: f64 = gains.iter().sum();
        // The tables rest on blocks and on a parabola in frequency; the last word is the fit's.
        let highest = self.tables.sum.iter().copied().fold(f64::MIN, f64::max);
        let p_value = (highest - self.tables.mean_ratio() - nats).exp().min(1.0);
        let loudest = (0..gains.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b]))?;
        let middle = moment.middle / self.blocks.len as f64;
        let others = ratio::others(self.lines, loudest, middle, self.longest);
        let left: f64 = pairs()
            .map(|(turned, line)| {
                line.seen
                    .left_over(turned.offset, Some(turned.turn), AROUND_LINE)
            })
            .sum();
        // Noise leaves as many as there are ordinates, with that variance.
        let spread = ((2 * AROUND_LINE + 1) as f64 * self.lines.len() as f64).sqrt();
        let explained = left < LEFT_SHARE * nats + 3.0 * spread;
        let lines = (0..self.lines.len()).map(|which| self.steady(chosen, which));
        (p_value < level && others > ODDS && explained).then(|| Loss {
            index: self.found[chosen].index(),
            index_sd: moment.sd,
            index_lo: moment.lo,
            index_hi: moment.hi,
            samples: best.samples as u32,
            samples_lo,
            samples_hi,
            nats,
            held_nats: held(self.lines, self.longest),
            p_value,
            // A harmonic that was only tried for is one if it is no chance.
            lines: lines.filter(|line| line.false_alarm() < level).collect(),
        })
    }

    /// Line number `which` of the chosen length.
    fn steady(&self, chosen: usize, which: usize) -> SteadyLine {
        let (turned, line) = (&self.found[chosen].turned[which], &self.lines[which]);
        let cycles = |turned: &Turned| line.cycles(turned.offset, self.blocks.len);
        SteadyLine {
            cycles: cycles(turned),
            cycles_sd: between(self.found, chosen, |one| cycles(&one.turned[which])).sqrt(),
            cosine: turned.amplitude.re,
            sine: -turned.amplitude.im,
            amplitude_sd: between(self.found, chosen, |one| one.turned[which].amplitude.norm())
                .sqrt(),
            nats: turned.gain,
        }
    }
}

/// Gains of all moments and lengths, and the best of them looked at closely.
fn looked(blocks: &Blocks, quiet: &Quiet, lines: &[Line], longest: usize) -> (Tables, Vec<Found>) {
    let tables = Tables::new(lines, longest);
    let found = tables
        .candidates()
        .into_iter()
        .map(|best| Found::new(blocks, quiet, lines, &tables, best))
        .collect();
    (tables, found)
}

/// A length looked at closely.
struct Found {
    best: Best,
    /// What is known of the moment, samples.
    moment: Posterior,
    turned: Vec<Turned>,
    /// Gain in log-likelihood over no lines at all.
    gain: f64,
}

impl Found {
    /// Gain in log-likelihood over steady lines, nats.
    fn nats(&self, lines: &[Line]) -> f64 {
        self.gain - lines.iter().map(|line| line.gain).sum::<f64>()
    }

    fn new(blocks: &Blocks, quiet: &Quiet, lines: &[Line], tables: &Tables, best: Best) -> Self {
        let mut moment = tables.moment(best.samples, blocks.len);
        let mut turned = fitted(lines, best.place as f64, best.samples);
        if moment.sd < blocks.len as f64 {
            moment = zoom(blocks, quiet, lines, &turned, best);
            turned = fitted(lines, moment.middle / blocks.len as f64, best.samples);
        }
        Self {
            best,
            moment,
            gain: turned.iter().map(|turned| turned.gain).sum(),
            turned,
        }
    }

    /// First sample after the loss.
    fn index(&self) -> usize {
        self.moment.middle.round() as usize
    }
}

/// Mean square distance of `value` among all that was looked at, each by its likelihood, from that
/// of the one chosen.
fn between(found: &[Found], chosen: usize, value: impl Fn(&Found) -> f64) -> f64 {
    let here = value(&found[chosen]);
    let (mut sum, mut weights) = (0.0, 0.0);
    for one in found {
        let weight = (one.gain - found[chosen].gain).exp();
        sum += weight * (value(one) - here).powi(2);
        weights += weight;
    }
    sum / weights
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

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
