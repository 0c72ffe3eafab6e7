//! Two levels read off the record, jump by jump, where they are so far apart that each jump is beyond doubt.
//!
//! Such a switching is no noise of any law that a fit looks at: it fills the spectrum, and all that lies below it has
//! neither a steady strength nor normal amplitudes. So it is taken out as the waveform that it is, before anything
//! else is looked for. What is read off must be what the law says: up and down by turns, by one height, held for
//! exponential times.

use std::ops::Range;
use std::sync::Arc;

use super::differences::{Differences, Seen, Sums};
use super::edge::{Known, Moment};
use super::is_to_and_fro;
use super::pulses;
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::Detector;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::{Jump, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::values::grid::grid;
use crate::model::telegraph::KIND;
use crate::numeric::order::median;

/// Jumps at least: by chance as many turn each time once in 30 000 records, and their dwells say whether they are exponential.
const LEAST: usize = 16;

/// Spreads of the differences that a jump has at least: five more than what stands out at all, so that none is missed.
const PLAIN: f64 = 12.0;

/// Share of a jump by which the level differs from the second half of one dwell to that of the next, at least: a choice.
/// Behind a capacitor that forgets within a dwell it is less.
const LASTS: f64 = 0.5;

/// Share of a jump that one has at least which was overlooked between two to one side: a choice. A dwell shorter than the
/// windows shows in part.
const OVERLOOKED: f64 = 0.25;

/// Kolmogorov's statistic of exponential times beyond which they are none, times the root of their number: with the mean taken
/// from them it is passed once in some thousand records (H. W. Lilliefors, J. Am. Stat. Assoc. 64 (1969) 387, table 1).
const KOLMOGOROV: f64 = 1.5;

/// Probability of so many short dwells, or of such long ones at the record's ends, below which they are none of the law's: a
/// choice, as rare as the above.
const SHORT: f64 = 1e-3;

/// Times that the course of a jump and the moments of all are taken from one another: a choice. What is left of a course
/// halves each time.
const TURNS: usize = 6;

/// The first of these, in which short dwells are added: a choice. A second look sees those that lie beside others.
const SHORT_DWELLS: usize = 3;

/// Reads two levels off a record. It has no share of the level: what it names is beyond any.
pub static DETECTOR: Detector = Detector { tests: 0, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    if look.axis.has(KIND) || !look.is_open(KIND) {
        return Ok(Vec::new());
    }
    let values = look.axis.residual.seen();
    let found = read_off(&values).map(|path| path.candidate(look.axis.rate_hz));
    Ok(found.into_iter().collect())
}

/// Two levels and where one goes over into the other.
struct Path {
    moments: Vec<Moment>,
    known: Known,
    /// Mean time at a level, samples.
    dwell: f64,
    /// Jumps over the spread of the differences that they were seen in.
    plain: f64,
}

/// The finest means that show two levels.
fn read_off(values: &[f64]) -> Option<Path> {
    let sums = Sums::new(values);
    // A level that lies between two codes goes to and fro between them, whatever the noise: rounding errs by the root of a
    // twelfth of a step on either side.
    let rounding = grid(values).map_or(0.0, |step| step * (2.0 / 12.0_f64).sqrt());
    let mut samples = 1;
    while 4 * LEAST * samples <= values.len() {
        let differences = Differences::new(&sums, samples, rounding);
        if differences.spread > 0.0
            && let Some(path) = Path::seen(values, &sums, &differences)
        {
            return Some(path);
        }
        samples *= 2;
    }
    None
}

impl Path {
    fn seen(values: &[f64], sums: &Sums, differences: &Differences) -> Option<Self> {
        let seen = whole(differences, sums)?;
        let mut heights: Vec<f64> = seen.iter().map(|one| one.height.abs()).collect();
        let plain = median(&mut heights)? / differences.spread;
        if plain < PLAIN || !are_two_levels(&seen, differences.spread) {
            return None;
        }
        let mut moments: Vec<Moment> = seen
            .iter()
            .map(|one| (one.index, one.height > 0.0))
            .collect();
        let mut known = Known::first(values, &moments)?;
        for turn in 0..TURNS {
            place(values, &mut moments, &known, differences.reach);
            known = known.again(values, &moments)?;
            if turn < SHORT_DWELLS {
                let mut left = values.to_vec();
                known.wave(&moments).take_out(&mut left);
                pulses::add(&left, 2 * differences.reach, &known, &mut moments);
            }
        }
        let dwell = mean_dwell(&moments, differences.reach)?;
        if !is_all_along(&moments, dwell, sums) {
            return None;
        }
        let path = Self {
            moments,
            known,
            dwell,
            plain,
        };
        path.lasts(sums, plain * differences.spread).then_some(path)
    }

    /// Whether the level is still the other one in the second half of a dwell, as it was at a jump of this `height`. Long
    /// dwells count more: there it shows.
    fn lasts(&self, sums: &Sums, height: f64) -> bool {
        let late = |two: &[Moment]| {
            let level = sums.mean(two[0].0.midpoint(two[1].0)..two[1].0)?;
            Some((level, (two[1].0 - two[0].0) as f64))
        };
        let levels: Vec<Option<(f64, f64)>> = self.moments.windows(2).map(late).collect();
        let rises = levels.windows(2).zip(&self.moments[1..]);
        let rises = rises.filter_map(|(two, jump)| {
            let ([before, after], sign) = ([two[0]?, two[1]?], if jump.1 { 1.0 } else { -1.0 });
            Some((sign * (after.0 - before.0), before.1.min(after.1)))
        });
        let (sum, weight) = rises.fold((0.0, 0.0), |(sum, weight), (rise, samples)| {
            (sum + rise * samples, weight + samples)
        });
        sum > LASTS * height * weight
    }

    fn candidate(self, rate_hz: f64) -> Proposal {
        let count = self.moments.len() as f64;
        let effect = Estimate::new(
            KIND,
            [
                Value::normal(self.known.height, self.known.height_sd),
                Value::log_normal(self.dwell / rate_hz, count.sqrt().recip()),
            ],
        );
        let change = Change::Waves(vec![Wave::Switching(Arc::new(
            self.known.wave(&self.moments),
        ))]);
        let nats = 0.5 * self.plain * self.plain * count;
        Proposal::Explain(Box::new(Candidate {
            held_out_nats: Some(nats),
            ..Candidate::new(effect, p_value::two_sided(self.plain), count + 2.0, change)
        }))
    }
}

/// The jumps that some differences show, with those that must lie between two to one side; `None` where one cannot be.
fn whole(differences: &Differences, sums: &Sums) -> Option<Vec<Seen>> {
    let mut jumps = differences.jumps();
    let mut heights: Vec<f64> = jumps.iter().map(|one| one.height.abs()).collect();
    let typical = median(&mut heights)?;
    jumps.retain(|one| one.height.abs() >= 0.5 * typical);
    if jumps.len() < LEAST {
        return None;
    }
    let mut all: Vec<Seen> = Vec::with_capacity(jumps.len());
    for jump in jumps {
        if let Some(last) = all.last().filter(|last| last.height * jump.height > 0.0) {
            let between = last.index + 1..jump.index;
            let back = -jump.height.signum();
            let seen = differences.largest_to(back, between.clone());
            let seen = seen.filter(|one| one.height.abs() >= OVERLOOKED * typical);
            all.push(match seen {
                Some(one) => one,
                // It happened while nothing was measured.
                None => Seen {
                    index: gap_with_jump(sums, between, differences.reach, back)?,
                    height: back * typical,
                },
            });
        }
        all.push(jump);
    }
    Some(all)
}

/// Middle of the gap between two moments across which the level goes furthest to one side, of those of `least` samples;
/// `None` where there is none.
fn gap_with_jump(sums: &Sums, between: Range<usize>, least: usize, side: f64) -> Option<usize> {
    let mut begin = between.start;
    let mut gaps: Vec<Range<usize>> = Vec::new();
    for n in between.clone() {
        if sums.count(n..n + 1) > 0 {
            begin = n + 1;
        } else if n + 1 == between.end || sums.count(n + 1..n + 2) > 0 {
            gaps.push(begin..n + 1);
        }
    }
    let rise = |gap: &Range<usize>| {
        let before = sums.mean(gap.start.saturating_sub(least)..gap.start);
        let behind = sums.mean(gap.end..(gap.end + least).min(sums.len()));
        Some(side * (behind? - before?))
    };
    let wide = gaps.into_iter().filter(|gap| gap.len() >= least);
    let rises = wide.map(|gap| (rise(&gap).unwrap_or(f64::NEG_INFINITY), gap));
    let (_, gap) = rises.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(gap.start.midpoint(gap.end))
}

fn are_two_levels(seen: &[Seen], spread: f64) -> bool {
    let jump = |one: &Seen| Jump {
        index: one.index,
        height: one.height,
        height_sd: spread,
        index_sd: 1.0,
        z: one.height / spread,
        p_value: 0.0,
    };
    is_to_and_fro(&seen.iter().map(jump).collect::<Vec<Jump>>())
}

/// Gives each jump the moment at which it fits best, no further from where it was seen than half of the way to the next.
fn place(values: &[f64], moments: &mut [Moment], known: &Known, reach: usize) {
    let before = moments.to_vec();
    let window = reach.max(2) + known.edge.beside.len() / 2;
    for (number, moment) in moments.iter_mut().enumerate() {
        let (at, up) = before[number];
        let from = number
            .checked_sub(1)
            .map_or(0, |one| before[one].0.midpoint(at));
        let next = before
            .get(number + 1)
            .map_or(values.len(), |one| one.0.midpoint(at) + 1);
        let within = from.max(at.saturating_sub(window))..next.min(at + window);
        moment.0 = known.moment(values, within, up).unwrap_or(at);
    }
    moments.sort_unstable_by_key(|one| one.0);
}

/// Mean time between `moments`, samples; `None` where the times are not exponential. Those up to `resolved` samples, of which
/// some are overlooked, are counted alone.
fn mean_dwell(moments: &[Moment], resolved: usize) -> Option<f64> {
    let dwells: Vec<usize> = moments.windows(2).map(|two| two[1].0 - two[0].0).collect();
    let is_long = |dwell: &&usize| **dwell > resolved;
    // An exponential law forgets: what is beyond a time is distributed as all of it.
    let mut beyond: Vec<f64> = dwells
        .iter()
        .filter(is_long)
        .map(|dwell| (dwell - resolved) as f64 - 0.5)
        .collect();
    if beyond.len() < LEAST / 2 {
        return None;
    }
    let count = beyond.len() as f64;
    let mean = beyond.iter().sum::<f64>() / count;
    beyond.sort_by(f64::total_cmp);
    let off = beyond.iter().enumerate().map(|(place, time)| {
        let expected = -(-time / mean).exp_m1();
        let share = place as f64 / count;
        (expected - share)
            .abs()
            .max((share + count.recip() - expected).abs())
    });
    let farthest = off.fold(0.0, f64::max) * count.sqrt();
    let short = count * (resolved as f64 / mean).exp_m1();
    let is_chance = p_value::poisson((dwells.len() - beyond.len()) as u64, short) > SHORT;
    let all = dwells.iter().sum::<usize>() as f64 / dwells.len() as f64;
    (farthest < KOLMOGOROV && is_chance).then_some(all)
}

/// Whether the record may begin and end so far from the first and the last of some `moments` where the mean time between two
/// is `dwell` samples: what goes to and fro for a while is something that happened.
fn is_all_along(moments: &[Moment], dwell: f64, sums: &Sums) -> bool {
    let [Some(first), Some(last)] = [moments.first(), moments.last()] else {
        return false;
    };
    let before = sums.count(0..first.0);
    let behind = sums.count(last.0..sums.len());
    // An exponential law forgets: both are such times, and their sum is one of two.
    let times = (before + behind) as f64 / dwell;
    (1.0 + times) * (-times).exp() > SHORT
}

#[cfg(test)]
mod tests;
