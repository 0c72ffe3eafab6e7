//! Single samples that do not belong: the matched filter for one sample, at every moment.
//!
//! The filter `1/S` measures how far a sample lies from what all others predict for it, in
//! standard deviations of that prediction (the interpolation error; A. N. Kolmogorov 1941). In
//! differenced noise it is far smaller than the noise itself.

use super::nearby::Height;
use super::pursuit::Pursuit;
use crate::diagnosis::record::wave::Outlier;
use crate::diagnosis::statistic::matched_filter::{Impulse, Transform, matched};
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::statistic::spread::middle_spread;

/// Outliers that are looked for, at most: a choice. Beyond it is another kind of record.
const MOST_OUTLIERS: usize = 1 << 14;

/// Samples to either side that an outlier's own answer of the filter is taken out of, at most: where
/// the density rises with the frequency the filter sums up, and remembers long.
const ANSWER_REACH: usize = 1 << 14;

/// Share of the answer's peak that does not matter any more, at most: an outlier of a thousand standard
/// deviations leaves one. A larger one leaves as much of a smaller share.
const NOTHING: f64 = 1e-3;

/// The outliers of a record, ascending, and the p-value of the largest.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Found {
    /// All outliers beyond the threshold.
    pub outliers: Vec<Outlier>,
    /// Probability that noise has a sample as far out anywhere.
    pub p_value: f64,
    /// Size from which one is seen.
    pub threshold: f64,
    /// Gain in log-likelihood on ordinates that the sizes were not fitted to.
    pub nats: f64,
}

/// Looks for outliers at a family-wise `level`, in noise of the densities `density` at the
/// ordinates of `whole`; `usable` says which samples count, `local` the deviation of the noise about
/// a sample over that of the record.
///
/// The filter's output is measured in units of its own middle spread where that is wider than the
/// model says, so that a model that is wrong elsewhere makes no outliers.
pub fn outliers(
    whole: &Transform,
    density: &[f64],
    level: f64,
    usable: impl Fn(usize) -> bool,
    local: impl Fn(usize) -> f64,
) -> Found {
    let filter = matched(whole, density, &Impulse);
    let middle = middle_spread(&filter.z).max(1.0);
    let spread = |index: usize| middle * local(index);
    let threshold = p_value::threshold(level, whole.len(), f64::INFINITY);
    let z = &filter.z;
    let mut candidates: Vec<usize> = (0..z.len())
        .filter(|&index| z[index].abs() > threshold * spread(index) && usable(index))
        .collect();
    let highest = candidates.iter().map(|&n| z[n].abs() / spread(n));
    let highest = highest.fold(0.0, f64::max);
    candidates.sort_by(|&a, &b| z[b].abs().total_cmp(&z[a].abs()));
    let size_sd = filter.size_sd;
    // One record's worth of memory at a time: the output is made again where the short answer is kept.
    drop(filter);
    if candidates.is_empty() {
        return Found {
            outliers: Vec::new(),
            p_value: 1.0,
            threshold: threshold * middle * size_sd,
            nats: 0.0,
        };
    }
    let answer = answer(whole, density, highest);
    let filter = matched(whole, density, &Impulse);
    let mut pursuit = Pursuit::new(filter.z, answer);
    // Largest first; each takes its own answer out of its neighbours.
    for index in candidates.into_iter().take(4 * MOST_OUTLIERS) {
        if pursuit.left()[index].abs() > threshold * spread(index) && pursuit.len() < MOST_OUTLIERS
        {
            pursuit.take(index, &usable);
        }
    }
    // One that was moved to a neighbouring sample may have nothing left to explain.
    let settled = pursuit.settle(|index, z| z.abs() > threshold * spread(index));
    let outlier = |(index, Height { height, sd }): (usize, Height)| Outlier {
        index,
        size: height * size_sd,
        size_sd: sd * size_sd * spread(index),
    };
    let found: Vec<Outlier> = settled.into_iter().map(outlier).collect();
    drop(pursuit);
    Found {
        p_value: p_value::highest(highest, whole.len(), f64::INFINITY),
        threshold: threshold * middle * size_sd,
        nats: gain(whole, density, &found),
        outliers: found,
    }
}

/// Gain in log-likelihood of these outliers on the ordinates that their sizes are not fitted to.
fn gain(whole: &Transform, density: &[f64], found: &[Outlier]) -> f64 {
    if found.is_empty() {
        return 0.0;
    }
    let filter = matched(whole, density, &Impulse);
    let gain = |one: &Outlier| {
        let [even, odd] = filter.halves(one.index);
        odd.gain(even.size())
    };
    found.iter().map(gain).sum()
}

/// Probability that as many outliers stand close to one another as do, if each came by itself:
/// what rings, or a tone that is switched on, goes beyond the threshold several times.
pub fn together(found: &[Outlier], len: usize) -> f64 {
    /// Samples that count as close: a choice, those within which two disturb one another's place.
    const CLOSE: usize = 64;
    let close = found
        .windows(2)
        .filter(|pair| pair[1].index - pair[0].index <= CLOSE);
    let count = found.len() as f64;
    p_value::poisson(
        close.count() as u64,
        count * count * CLOSE as f64 / len as f64,
    )
}

/// The filter's answer to one sample of size one, from that moment on, over its peak, as far as it
/// matters to a sample of `highest` standard deviations.
fn answer(whole: &Transform, density: &[f64], highest: f64) -> Vec<f64> {
    let answer = whole.answer(|k| density[k].recip());
    let peak = answer[0];
    let mut answer = answer[..ANSWER_REACH.min(answer.len() / 2)].to_vec();
    let nothing = NOTHING.min(highest.recip());
    let matters = |value: &f64| value.abs() > nothing * peak;
    let end = answer.iter().rposition(matters).map_or(0, |last| last + 1);
    answer.truncate(end);
    answer.iter_mut().for_each(|value| *value /= peak);
    answer
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{LEVEL, Trial, noise};

    /// Places of what is found among the samples that `count`, in noise with a large one at 9001, held against a density
    /// that is so many times as `high` as its own.
    fn places(seed: u64, size: f64, high: f64, count: bool) -> Vec<usize> {
        let mut values = noise(seed);
        values[9001] += size;
        let seen = Trial::new(values).axis.whitened();
        let density: Vec<f64> = seen.density.iter().map(|one| high * one).collect();
        let found = outliers(&seen.transform, &density, LEVEL, |_| count, |_| 1.0);
        found.outliers.iter().map(|one| one.index).collect()
    }

    #[test]
    fn samples_that_do_not_count_are_none() {
        for seed in 0..3 {
            assert_eq!(places(seed, 15.0, 1.0, true), [9001], "seed {seed}");
            assert!(places(seed, 15.0, 1.0, false).is_empty(), "seed {seed}");
        }
    }

    #[test]
    fn noise_three_times_as_loud_as_its_model_has_none() {
        for seed in 3..6 {
            let found = places(seed, 0.0, 1.0 / 9.0, true);
            assert!(found.is_empty(), "seed {seed}: {found:?}");
        }
    }
}
