//! Held: the sensor has new values more rarely than the record has samples, and each is written until there is the next.
//!
//! Most of the samples are then no measurements, and the spectrum is one of stairs. Where new values come as a clock has it,
//! each of them once is a record of its own, sampled evenly at the sensor's rate: it is what is diagnosed. Repeats that come by
//! chance are [`stale`](super::stale).

use crate::diagnosis::record::samples::{Samples, Seen};
use crate::diagnosis::refused::{LEAST, Refused};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::{AxisDiagnosis, Finding};
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::p_value;
use crate::model::axis::ModelEffect;
use crate::model::held::KIND;

/// Tests that it makes: its share of the family's level.
pub const TESTS: u32 = 1;

/// Share of the samples that repeat the one before, at least: a choice. What fewer do to a spectrum is little, and they are
/// told as stale.
const SHARE: f64 = 0.01;

/// Variance, in samples, that the sum of so many runs of one value would have if they knew nothing of each other: a choice.
/// That of a clock's runs, however many, is at most a sixth: both ends are off by the part of a sample.
const UNRELATED: f64 = 4.0;

/// Such sums at least: a clock's are then told from others by more than chance.
const SUMS: usize = 32;

/// Share of the variance of unrelated runs that a clock's have at most: a choice, four times what one has that is even.
const CLOCKED: f64 = 0.25;

/// Values that are held, all axes alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// New values a sample.
    values: f64,
    /// Standard deviation of that.
    values_sd: f64,
    /// The sample that each value is first seen in; `None` where it was missed.
    samples: Vec<Option<usize>>,
    /// Probability that runs which know nothing of each other are so even.
    p_value: f64,
}

/// A new value.
#[derive(Debug, Clone, Copy)]
struct Fresh {
    sample: usize,
    /// Whether the sample before was measured too.
    is_exact: bool,
}

impl Held {
    /// That of a record, at the `level` of one test; `None` where its samples are values of their own.
    ///
    /// # Errors
    /// [`Refused::Held`] where these are too few to be diagnosed.
    pub fn of(record: &Samples, level: f64) -> Result<Option<Self>, Refused> {
        let has_converter = record.signal.axes.iter().any(|axis| {
            let chain = axis.chain.as_ref();
            chain.is_some_and(|chain| chain.converter.is_some())
        });
        // The rate of a declared converter is known.
        if has_converter {
            return Ok(None);
        }
        // Most records hold nothing, and need no room for their new values.
        let repeats = record.seen().filter(|seen| *seen == Seen::Same).count();
        if (repeats as f64) < SHARE * record.len() as f64 {
            return Ok(None);
        }
        let Some(held) = Self::of_values(record.seen(), level) else {
            return Ok(None);
        };
        let values = held.samples.iter().flatten().count();
        if values < LEAST {
            return Err(Refused::Held {
                values,
                samples: record.len(),
            });
        }
        Ok(Some(held))
    }

    fn of_values(seen: impl Iterator<Item = Seen>, level: f64) -> Option<Self> {
        let fresh = fresh(seen);
        let runs = runs(&fresh);
        let count = runs.len() as f64;
        let mean = runs.iter().sum::<f64>() / count;
        let evenness = evenness(&runs, mean)?;
        if evenness.ratio > CLOCKED || evenness.p_value >= level {
            return None;
        }
        let samples = in_order(&fresh, mean);
        let (first, last) = (fresh.first()?.sample, fresh.last()?.sample);
        let between = (samples.len() - 1) as f64;
        let values = between / (last - first) as f64;
        // Each end is off by the part of a sample.
        let values_sd = values / (last - first) as f64 * f64::sqrt(2.0 / 12.0);
        Some(Self {
            values,
            values_sd,
            samples,
            p_value: evenness.p_value,
        })
    }

    /// The record of the values, each once.
    pub fn values(&self, record: &Samples) -> Samples {
        let mut values = record.picked(&self.samples);
        values.signal.rate_hz *= self.values;
        values
    }

    /// What was recorded with it, one for each value.
    pub fn beside(&self, column: &[f64]) -> Vec<f64> {
        let due = |value: usize| (value as f64 / self.values) as usize;
        let last = column.len().saturating_sub(1);
        let places = self.samples.iter().enumerate();
        let places = places.map(|(value, sample)| sample.unwrap_or(due(value)).min(last));
        places
            .filter_map(|place| column.get(place).copied())
            .collect()
    }

    /// Says so of an axis of a record of `rate_hz` samples a second, ahead of all else, and makes it part of its last
    /// model; one that could not be diagnosed has neither.
    pub fn tell(&self, axis: &mut AxisDiagnosis, rate_hz: f64) {
        if axis.refused.is_some() {
            return;
        }
        let sensor_hz = Value::normal(self.values * rate_hz, self.values_sd * rate_hz);
        let estimate = Estimate::new(KIND, [sensor_hz]);
        let effect = ModelEffect::of(KIND, &estimate.plain());
        axis.last.model.effects.extend(effect);
        axis.findings
            .insert(0, Finding::new(&estimate, self.p_value));
    }
}

/// The new values of a record.
fn fresh(seen: impl Iterator<Item = Seen>) -> Vec<Fresh> {
    let mut was_measured = false;
    let fresh = seen.enumerate().filter_map(|(sample, seen)| {
        let is_exact = std::mem::replace(&mut was_measured, seen != Seen::Missing);
        (seen == Seen::New).then_some(Fresh { sample, is_exact })
    });
    fresh.collect()
}

/// Lengths of the runs whose ends are both known, samples.
fn runs(fresh: &[Fresh]) -> Vec<f64> {
    let pairs = fresh.windows(2);
    let known = pairs.filter(|two| two[0].is_exact && two[1].is_exact);
    known
        .map(|two| (two[1].sample - two[0].sample) as f64)
        .collect()
}

/// How even runs are.
struct Evenness {
    /// Variance of sums of them, over that of unrelated ones.
    ratio: f64,
    /// Probability that unrelated ones are as even.
    p_value: f64,
}

/// How even runs of this `mean` are; `None` where they are too few to say, or none is longer than a sample.
fn evenness(runs: &[f64], mean: f64) -> Option<Evenness> {
    if mean <= 1.0 {
        return None;
    }
    let square = |values: &[f64], about: f64| {
        let squares = values.iter().map(|value| (value - about).powi(2));
        squares.sum::<f64>() / values.len() as f64
    };
    let own = square(runs, mean);
    let each = (UNRELATED / own).ceil();
    let of = |ratio: f64, count: usize| {
        let p_value = p_value::mean_square(ratio, (count - 1) as f64);
        Evenness { ratio, p_value }
    };
    if each <= (runs.len() / SUMS) as f64 {
        let sums = runs.chunks_exact(each as usize);
        let sums: Vec<f64> = sums.map(|some| some.iter().sum()).collect();
        let about = sums.iter().sum::<f64>() / sums.len() as f64;
        return Some(of(square(&sums, about) / (each * own), sums.len()));
    }
    // All of about one length: by chance they would be geometric.
    (runs.len() > SUMS).then(|| of(own / (mean * (mean - 1.0)), runs.len()))
}

/// The sample of each value of a clock with this many samples a value on average.
fn in_order(fresh: &[Fresh], mean: f64) -> Vec<Option<usize>> {
    let mut samples: Vec<Option<usize>> = Vec::new();
    let mut last: Option<usize> = None;
    for one in fresh {
        let run = last.map_or(0.0, |last| (one.sample - last) as f64);
        // One value may take a sample more than a clock gives it; beyond, some were missed, or the same twice.
        let steps = if run <= mean.ceil() + 1.0 {
            1.0
        } else {
            (run / mean).round()
        };
        for _ in 1..steps as usize {
            samples.push(None);
        }
        samples.push(Some(one.sample));
        last = Some(one.sample);
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::numbers;

    const LEVEL: f64 = 1e-4;

    /// What is seen of values that are each held for `lengths` samples.
    fn held(lengths: impl Iterator<Item = usize>, count: usize) -> Vec<Seen> {
        let runs = lengths.flat_map(|length| {
            let repeats = std::iter::repeat_n(Seen::Same, length - 1);
            std::iter::once(Seen::New).chain(repeats)
        });
        runs.take(count).collect()
    }

    /// Lengths of a clock with so many samples a value.
    fn clock(ratio: f64) -> impl Iterator<Item = usize> {
        let start = move |value: u32| (f64::from(value) * ratio).ceil() as usize;
        (0..).map(move |value| start(value + 1) - start(value))
    }

    /// Lengths of 1 with repeats by chance.
    fn chance(seed: u64, share: f64) -> impl Iterator<Item = usize> {
        let mut normal = numbers(seed, 0);
        let mut uniform = move || {
            let square = normal.draw().powi(2) + normal.draw().powi(2);
            (-0.5 * square).exp()
        };
        std::iter::repeat_with(move || {
            let mut length = 1;
            while uniform() < share {
                length += 1;
            }
            length
        })
    }

    fn found(seen: &[Seen]) -> Option<Held> {
        Held::of_values(seen.iter().copied(), LEVEL)
    }

    #[test]
    fn a_clock_is_found_with_its_rate_and_the_sample_of_each_value() {
        for ratio in [1.05, 1.37, 2.0, 2.5, 7.7485] {
            let held = found(&held(clock(ratio), 200_003)).expect("a clock");
            let off = (held.values * ratio - 1.0) / (held.values_sd * ratio);
            assert!(off.abs() < 4.0, "{ratio}: {off}");
            let expected = |value: usize| Some((value as f64 * ratio).ceil() as usize);
            let is_right = |(value, sample): (usize, &Option<usize>)| *sample == expected(value);
            assert!(held.samples.iter().enumerate().all(is_right), "{ratio}");
        }
    }

    #[test]
    fn repeats_by_chance_are_no_clock() {
        for seed in 0..8 {
            for share in [0.02, 0.2, 0.6] {
                assert_eq!(
                    found(&held(chance(seed, share), 200_003)),
                    None,
                    "seed {seed}"
                );
            }
            // Pairs, but for some that are none: each length is a clock's, their order is not.
            let pairs = chance(seed, 0.82).map(|length| length.min(2));
            assert_eq!(found(&held(pairs, 200_003)), None, "seed {seed}: pairs");
        }
        assert_eq!(found(&vec![Seen::New; 200_003]), None, "no repeats");
    }

    #[test]
    fn values_keep_their_place_across_gaps_and_where_two_are_the_same() {
        let ratio = 4.3;
        let mut seen = held(clock(ratio), 200_003);
        let start = |value: usize| (value as f64 * ratio).ceil() as usize;
        seen[start(1000)..start(1010)].fill(Seen::Missing);
        seen[start(2000)] = Seen::Same;
        let held = found(&seen).expect("a clock");
        assert_eq!(held.samples[1000..1010], [None; 10]);
        assert_eq!(held.samples[2000], None);
        for value in [999, 1010, 1999, 2001, 40_000] {
            assert_eq!(held.samples[value], Some(start(value)), "{value}");
        }
    }
}
