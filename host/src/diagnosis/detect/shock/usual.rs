//! What the powers of short windows are where nothing happens, and how far a window stands out of that.
//!
//! How strong the noise is at a frequency, the record's own windows say: the middle of their powers, which events do
//! not move.

#[cfg(test)]
mod tests;

use std::ops::Range;

use rayon::prelude::*;

use super::windows::{Scratch, Windows};
use crate::diagnosis::statistic::tails::{Rare, narrow, normal_of_log, normal_of_mean, tail};
use crate::numeric::order::median;

/// Powers that the usual strength is taken from, at most: a choice. A median of so many at one frequency and
/// those about it is known to some percent.
const POWERS: usize = 1 << 18;

/// Windows that it is taken from, at most: a choice.
const SEEN_WINDOWS: usize = 2048;

/// Powers that one strength rests on, at least, where as many are there: windows at one frequency and those
/// about it. Their median is known to 9 %.
const RESTS_ON: usize = 256;

/// Ordinates of a sum that is judged, at least: of fewer each is judged by itself.
const SUMMED: usize = 4;

/// Parts of the record that are compared: a choice.
const PARTS: usize = 32;

/// What windows of one length are where nothing happens.
pub struct Usual {
    /// Windows of this length.
    pub windows: Windows,
    unit: f64,
    /// Usual power by frequency, and how many independent powers it rests on.
    power: Vec<f64>,
    inverse: Vec<f64>,
    rests_on: Vec<f64>,
    groups: Vec<Group>,
    rare: Option<Rare>,
}

/// Frequencies an octave apart that are judged alike.
struct Group {
    bins: Range<usize>,
    /// How much wider than a normal law's the tail is, of single powers and of their sum.
    tail: f64,
    tail_of_sum: f64,
}

/// How far a window stands out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Height {
    /// In deviations of a normal law of as small a probability.
    pub z: f64,
    /// The number of the frequency at which it does, in cycles a window.
    pub cycles: usize,
}

impl Usual {
    /// Of a record in units of `unit`, whose windows begin at `starts`; `least` is a power that rounding makes
    /// at any frequency. `None` where they are too few.
    pub fn new(
        windows: Windows,
        values: &[f64],
        unit: f64,
        starts: &[usize],
        least: f64,
    ) -> Option<Self> {
        /// Windows of which half say what is usual: a choice.
        const LEAST_WINDOWS: usize = 24;
        let bins = windows.bins();
        let most = (POWERS / bins).clamp(LEAST_WINDOWS, SEEN_WINDOWS);
        if starts.len() < LEAST_WINDOWS {
            return None;
        }
        let step = starts.len().div_ceil(most);
        let chosen: Vec<usize> = starts.iter().copied().step_by(step).collect();
        let mut seen: Vec<f64> = Vec::with_capacity(chosen.len() * bins);
        let mut scratch = windows.scratch();
        for &start in &chosen {
            seen.extend(windows.powers(values, unit, start, &mut scratch));
        }
        let mut usual = Self {
            windows,
            unit,
            power: Vec::new(),
            inverse: Vec::new(),
            rests_on: Vec::new(),
            groups: Vec::new(),
            rare: None,
        };
        usual.settle_powers(&seen, chosen.len(), step, least);
        usual.settle_tails(&seen, chosen.len());
        Some(usual)
    }

    fn settle_powers(&mut self, seen: &[f64], rows: usize, step: usize, least: f64) {
        let bins = self.windows.bins();
        let column = |bin: usize| (0..rows).map(move |row| seen[row * bins + bin]);
        let own: Vec<f64> = (0..bins)
            .map(|bin| median(&mut column(bin).collect::<Vec<f64>>()).unwrap_or(0.0))
            .collect();
        // Windows that overlap by half share a sixth of their power.
        let independent = if step == 1 { 0.8 } else { 1.0 };
        let reach = RESTS_ON.div_ceil(2 * rows);
        // Half of exponential powers lie below ln 2 of their mean.
        let floor = least * self.windows.taper.iter().map(|one| one * one).sum::<f64>();
        // What a filter shuts out is not what happens.
        let stop = self.shut_out(&own);
        for bin in 0..bins {
            let floor = if bin + 1 > self.windows.len() / 5 {
                floor.max(stop)
            } else {
                floor
            };
            // Few octaves up from zero the noise may be steep.
            let reach = reach.min(bin / 4).min(bins - 1 - bin);
            let mut near = own[bin - reach..=bin + reach].to_vec();
            let about = median(&mut near).unwrap_or(0.0);
            let power = own[bin].max(about) / std::f64::consts::LN_2;
            self.power.push(power.max(floor).max(f64::MIN_POSITIVE));
            self.inverse.push(self.power[bin].recip());
            // A median knows a scale as well as the mean of half as many.
            self.rests_on
                .push(0.48 * independent * rows as f64 * (2 * reach + 1) as f64);
        }
    }

    /// The least power that counts in the upper part of the band, given the middle power of each frequency: what
    /// lies far below it is what a converter's filter shuts out.
    fn shut_out(&self, own: &[f64]) -> f64 {
        /// 30 dB are a choice.
        const SHUT_OUT: f64 = 1e-3;
        let len = self.windows.len();
        let mut about = own[len / 8..len / 4].to_vec();
        SHUT_OUT * median(&mut about).unwrap_or(0.0) / std::f64::consts::LN_2
    }

    /// Variance of white noise that would hardly count in the upper part of the band, in squared units of the record.
    pub fn faint(&self) -> f64 {
        let own: Vec<f64> = self
            .power
            .iter()
            .map(|one| one * std::f64::consts::LN_2)
            .collect();
        let squares = self.windows.taper.iter().map(|one| one * one).sum::<f64>();
        self.shut_out(&own) / squares * self.unit * self.unit
    }

    fn settle_tails(&mut self, seen: &[f64], rows: usize) {
        let bins = self.windows.bins();
        let octaves = std::iter::successors(Some(0), |from| Some(2 * from + 1));
        let octaves = octaves.take_while(|from| *from < bins);
        let mut groups: Vec<Range<usize>> =
            octaves.map(|from| from..(2 * from + 1).min(bins)).collect();
        // All of them together, for what is short.
        groups.push(0..bins);
        let row = |at: usize| &seen[at * bins..(at + 1) * bins];
        let part = rows.div_ceil(PARTS).max(1);
        let parts = || {
            (0..rows)
                .step_by(part)
                .map(|from| from..(from + part).min(rows))
        };
        let groups = groups.into_iter().map(|group| {
            let of_part = |part: Range<usize>| -> Vec<f64> {
                let cells = part.flat_map(|at| {
                    let cells = group.clone().map(move |bin| (bin, row(at)[bin]));
                    cells.map(|(bin, power)| self.surprise(bin, power * self.inverse[bin]))
                });
                cells.collect()
            };
            let singles = tail(parts().map(of_part).collect(), |surprise| {
                normal_of_log(-surprise)
            });
            let sum = |at: usize| {
                let sum = group.clone().map(|bin| row(at)[bin] * self.inverse[bin]);
                normal_of_mean(sum.sum::<f64>() / group.len() as f64, narrow(group.len()))
            };
            let of_sum = |part: Range<usize>| part.map(sum).collect();
            Group {
                tail: singles,
                tail_of_sum: tail(parts().map(of_sum).collect(), |z| z),
                bins: group.clone(),
            }
        });
        self.groups = groups.collect();
    }

    /// Less the logarithm of the probability of as large a ratio to the usual power: exponential about a mean that is
    /// known by as many others.
    fn surprise(&self, bin: usize, ratio: f64) -> f64 {
        let many = self.rests_on[bin];
        many * (ratio / many).ln_1p()
    }

    /// How far the window at `start` stands out; nothing where that is less than `from`.
    pub fn height(
        &self,
        values: &[f64],
        start: usize,
        from: f64,
        (scratch, seen): &mut (Scratch, Vec<f64>),
    ) -> Height {
        seen.clear();
        let powers = self.windows.powers(values, self.unit, start, scratch);
        seen.extend(
            powers
                .zip(&self.inverse)
                .map(|(power, inverse)| power * inverse),
        );
        let mut highest = Height { z: 0.0, cycles: 1 };
        let mut all = (0.0, 0.0, 0);
        let octaves = self.groups.len() - 1;
        for (number, group) in self.groups.iter().enumerate() {
            let (sum, most, bin) = if number == octaves {
                all
            } else {
                plainest(seen, &group.bins)
            };
            if number < octaves {
                all = (
                    all.0 + sum,
                    f64::max(all.1, most),
                    if most > all.1 { bin } else { all.2 },
                );
            }
            let mut z: f64 = 0.0;
            // A probability is no less than that of an exponential number.
            let needed = from * group.tail;
            if most > 0.5 * needed * needed && number < octaves {
                z = normal_of_log(-self.surprise(bin, most)) / if crate::diagnosis::off("e1") { 1.0 } else { group.tail };
            }
            let count = group.bins.len();
            let mean = sum / count as f64;
            if count >= SUMMED && mean > 1.0 {
                z = z.max(normal_of_mean(mean, narrow(count)) / if crate::diagnosis::off("e2") { 1.0 } else { group.tail_of_sum });
            }
            if z >= from && z > highest.z {
                highest = Height { z, cycles: bin + 1 };
            }
        }
        highest.z = self.rare.map_or(highest.z, |rare| rare.normal(highest.z));
        highest
    }

    /// Heights of the windows at `starts`, of those that are `from` or higher. How rare a height is, the heights
    /// below it say; where there are too few, it is as `elsewhere`.
    pub fn heights(
        &mut self,
        values: &[f64],
        starts: &[usize],
        from: f64,
        elsewhere: Option<Rare>,
    ) -> Vec<(usize, Height)> {
        /// Below it no height is rare.
        const LOW: f64 = 2.5;
        let memory = || (self.windows.scratch(), Vec::new());
        let all = starts.par_iter().with_min_len(64);
        let all = all.map_init(memory, |memory, &start| {
            (start, self.height(values, start, LOW, memory))
        });
        let mut high: Vec<(usize, Height)> = all.filter(|(_, height)| height.z >= LOW).collect();
        let places = high.chunk_by(|one, next| next.0 - one.0 <= self.windows.len());
        let highest = places.map(|place| place.iter().map(|(_, one)| one.z).fold(LOW, f64::max));
        let rare = Rare::of(highest.collect()).or(elsewhere);
        self.rare = rare;
        high.iter_mut()
            .for_each(|(_, one)| one.z = rare.map_or(one.z, |rare| rare.normal(one.z)));
        high.retain(|(_, height)| height.z >= from);
        high
    }

    /// How slowly heights become rarer.
    pub const fn rare(&self) -> Option<Rare> {
        self.rare
    }

    /// The frequency of a height, cycles a sample.
    pub fn frequency(&self, height: Height) -> f64 {
        height.cycles as f64 / self.windows.len() as f64
    }
}

/// Sum, largest value and its place.
fn plainest(values: &[f64], range: &Range<usize>) -> (f64, f64, usize) {
    let mut all = (0.0, 0.0, range.start);
    for (place, &value) in range.clone().zip(&values[range.clone()]) {
        all.0 += value;
        if value > all.1 {
            (all.1, all.2) = (value, place);
        }
    }
    all
}
