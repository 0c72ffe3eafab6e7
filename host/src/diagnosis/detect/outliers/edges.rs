//! Single samples at the ends of a record and beside its gaps, where the matched filter has nothing on one side.
//!
//! A sample is held against the median of those next to it, and how far it lies from that against how far others do
//! from as many on either side: that is known from the record itself, whatever the colour of its noise.

use std::ops::Range;

use statrs::distribution::{ContinuousCDF, Normal};

use super::filter::{Found, together};
use crate::diagnosis::record::runs::runs_of;
use crate::diagnosis::record::wave::Outlier;
use crate::diagnosis::statistic::p_value;
use crate::numeric::order::{median, quantile};

/// Samples that one is held against: a choice. The median of sixteen is known to a third of the deviation of one.
const NEIGHBOURS: usize = 16;

/// Samples within which another that stands out makes both of them part of something longer, unless so many stand out
/// all over the record that some come together: a choice, four times as many as neighbours.
const ALONE: usize = 64;

/// Chance from which as many come together by themselves: a choice. Two alone in 5000 samples do with less.
const BY_CHANCE: f64 = 0.05;

/// Places whose distances say what is usual, about: the share below is then known from forty.
const PLACES: usize = 4096;

/// Share of usual distances whose largest is their measure: a record may hold a hundredth of samples that do not belong
/// before they are the measure.
const USUAL: f64 = 0.99;

/// Those of `found`, and with them the samples of the record that are not `usable` for the filter and stand out by
/// themselves at a `level`. NaN in `values` where samples are missing.
pub fn with_edges(
    mut found: Found,
    values: &[f64],
    usable: impl Fn(usize) -> bool,
    level: f64,
) -> Found {
    let runs = runs_of(values.len(), |index| values[index].is_finite());
    let runs: Vec<Range<usize>> = runs
        .into_iter()
        .filter(|run| run.len() > NEIGHBOURS)
        .collect();
    let unseen = || {
        runs.iter()
            .flat_map(|run| run.clone().map(move |index| (run, index)))
    };
    let unseen = || unseen().filter(|(_, index)| !usable(*index));
    let trials = unseen().count();
    let (Some(distances), true) = (Distances::new(values), trials > 0) else {
        return found;
    };
    let threshold = p_value::threshold(level, trials, f64::INFINITY);
    let far = unseen().map(|(run, index)| distances.outlier(run, index));
    let far: Vec<Outlier> = far
        .filter(|one| one.size.abs() > threshold * one.size_sd)
        .collect();
    let all = [found.outliers.as_slice(), far.as_slice()];
    let by_chance = together(&sorted(all.concat()), values.len()) > BY_CHANCE;
    for (place, one) in far.iter().enumerate() {
        let near = |other: &Outlier| one.index.abs_diff(other.index) <= ALONE;
        let is_alone =
            !far[..place].last().is_some_and(near) && !far.get(place + 1).is_some_and(near);
        if !(is_alone || by_chance) {
            continue;
        }
        let z = one.size.abs() / one.size_sd;
        let p_value = p_value::highest(z, trials, f64::INFINITY);
        found.p_value = if found.outliers.is_empty() {
            p_value
        } else {
            found.p_value.min(p_value)
        };
        // What its size explains, less its cost.
        found.nats += 0.5 * z * z - 1.0;
        found.outliers.push(*one);
    }
    found.outliers = sorted(found.outliers);
    found
}

fn sorted(mut outliers: Vec<Outlier>) -> Vec<Outlier> {
    outliers.sort_by_key(|one| one.index);
    outliers
}

/// How far the samples of a record lie from their neighbours.
struct Distances<'a> {
    values: &'a [f64],
    /// What is usual, with so many neighbours before the sample, as a standard deviation.
    usual: [f64; NEIGHBOURS + 1],
}

impl<'a> Distances<'a> {
    /// `None` where no samples stand together, or most do not change.
    fn new(values: &'a [f64]) -> Option<Self> {
        let deviations = Normal::standard().inverse_cdf(0.5 * (1.0 + USUAL));
        let mut usual = [0.0; NEIGHBOURS + 1];
        let windows = values.len().checked_sub(NEIGHBOURS)?;
        let stride = windows.div_ceil(PLACES).max(1);
        for (before, usual) in usual.iter_mut().enumerate() {
            let all = (0..windows)
                .step_by(stride)
                .map(|first| distance(values, first + before, before));
            let mut all: Vec<f64> = all.map(f64::abs).filter(|one| one.is_finite()).collect();
            *usual = quantile(&mut all, USUAL)? / deviations;
        }
        (usual.iter().all(|one| *one > 0.0)).then_some(Self { values, usual })
    }

    /// The sample at `index` of a `run` as one that does not belong.
    fn outlier(&self, run: &Range<usize>, index: usize) -> Outlier {
        let (to_start, to_end) = (index - run.start, run.end - 1 - index);
        let before = (NEIGHBOURS / 2)
            .max(NEIGHBOURS.saturating_sub(to_end))
            .min(to_start);
        Outlier {
            index,
            size: distance(self.values, index, before),
            size_sd: self.usual[before],
        }
    }
}

/// How far a sample lies from the median of its neighbours, `before` of them before it; NaN where one is missing.
fn distance(values: &[f64], index: usize, before: usize) -> f64 {
    let first = index - before;
    let mut others = values[first..=first + NEIGHBOURS].to_vec();
    let own = others.remove(before);
    if others.iter().any(|one| !one.is_finite()) {
        return f64::NAN;
    }
    own - median(&mut others).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::noise;

    const LEVEL: f64 = 1e-4;

    /// Places of what is found among the first and last hundred of some values and about a gap in their middle.
    fn places(values: &[f64]) -> Vec<usize> {
        let middle = values.len() / 2;
        let usable = |index: usize| {
            let from_end = index.min(values.len() - 1 - index);
            from_end >= 100 && index.abs_diff(middle) > 200
        };
        let found = with_edges(Found::default(), values, usable, LEVEL);
        found.outliers.iter().map(|one| one.index).collect()
    }

    #[test]
    fn single_samples_are_found_at_both_ends_and_beside_gaps() {
        for seed in 40..44 {
            let mut values = noise(seed);
            let (last, middle) = (values.len() - 1, values.len() / 2);
            values[middle..middle + 100].fill(f64::NAN);
            assert!(places(&values).is_empty(), "seed {seed}: nothing is there");
            let far = [0, middle - 1, middle + 100, last];
            far.iter().for_each(|&place| values[place] += 15.0);
            assert_eq!(places(&values), far, "seed {seed}");
        }
    }

    #[test]
    fn what_goes_on_for_longer_than_a_sample_is_none() {
        let mut values = noise(50);
        values[..3].iter_mut().for_each(|value| *value += 15.0);
        assert!(places(&values).is_empty());
    }

    #[test]
    fn two_that_came_together_by_chance_are_two() {
        for seed in 60..63 {
            let mut values = noise(seed);
            values[10] += 15.0;
            values[40] -= 15.0;
            assert!(
                places(&values).is_empty(),
                "seed {seed}: alone in the record"
            );
            // Among so many more than half a pair is expected within 64 samples.
            let len = values.len();
            let many = (1..=16).map(|n| Outlier {
                index: n * len / 17,
                size: 15.0,
                size_sd: 1.0,
            });
            let found = Found {
                outliers: many.collect(),
                ..Found::default()
            };
            let all = with_edges(found, &values, |n| n >= 100, LEVEL).outliers;
            let first: Vec<usize> = all.iter().map(|one| one.index).take(2).collect();
            assert_eq!(first, [10, 40], "seed {seed}");
        }
    }

    #[test]
    fn noise_alone_has_none() {
        // At a level of 1e-4 a record: one in sixty has a probability of 6e-3.
        let alarms = (100..160).filter(|&seed| !places(&noise(seed)).is_empty());
        let alarms: Vec<u64> = alarms.collect();
        assert!(alarms.is_empty(), "seeds {alarms:?}");
    }

    #[test]
    fn where_most_samples_do_not_change_nothing_is_usual() {
        let mut values = vec![0.0; 5000];
        values[0] = 1.0;
        assert!(places(&values).is_empty());
    }
}
