//! Samples that repeat the one before, more often than chance has it.

use super::chance::Chance;
use crate::diagnosis::statistic::p_value;

/// Samples that repeat the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stale {
    /// How many repeats there are beyond chance.
    pub count: f64,
    /// Share of these in all samples.
    pub share: f64,
    /// Standard deviation of the share.
    pub share_sd: f64,
    /// How many come in a row on average, and the standard deviation of that; none where a repeat tells nothing of
    /// the sample behind it.
    pub run_samples: Option<(f64, f64)>,
    /// Probability of as many by chance.
    pub p_value: f64,
}

/// Share of the repeats that chance may have where their runs are looked at: repeats by chance on a grid follow each
/// other more often than independent ones, by 15 % on white noise.
const FEW: f64 = 0.05;

/// Repeats in a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Repeats {
    /// Pairs of neighbours that are both measured.
    pub pairs: usize,
    /// How many of them are two of the same.
    pub count: usize,
    /// Repeats whose sample behind is measured too.
    pub followed: usize,
    /// How many of these are followed by another repeat.
    pub by_another: usize,
}

impl Repeats {
    /// Those at `places` of a record with NaN for what is missing.
    pub fn new(measured: &[f64], places: &[usize]) -> Self {
        let is_pair = |pair: &&[f64]| pair.iter().all(|value| value.is_finite());
        let is_measured =
            |&&place: &&usize| measured.get(place + 1).is_some_and(|next| next.is_finite());
        let neighbours = |pair: &&[usize]| pair[1] == pair[0] + 1;
        Self {
            pairs: measured.windows(2).filter(is_pair).count(),
            count: places.len(),
            followed: places.iter().filter(is_measured).count(),
            by_another: places.windows(2).filter(neighbours).count(),
        }
    }
}

/// These `repeats`, if they are more than `chance` has at the `level` of one test.
pub fn stale(repeats: Repeats, chance: Chance, level: f64) -> Option<Stale> {
    let run_samples = (chance.count < FEW * repeats.count as f64)
        .then(|| runs(repeats, level))
        .flatten();
    let (repeats, total) = (repeats.count as f64, repeats.pairs as f64);
    let sd = (repeats.max(chance.count) + chance.variance)
        .sqrt()
        .max(1.0);
    let p_value = chance.exceeded(repeats);
    let count = repeats - chance.count;
    // A number of runs of geometric lengths varies by so much more than one of single samples.
    let more = run_samples.map_or(1.0, |(run, _)| (2.0 * run - 1.0).sqrt());
    (p_value < level && repeats > 2.0).then(|| Stale {
        count,
        share: count / total,
        share_sd: more * sd / total,
        run_samples,
        p_value,
    })
}

/// How many repeats are in a row on average, and its standard deviation, where they follow each other more often or
/// more rarely than ones that know nothing of each other, at the `level` of one test.
fn runs(repeats: Repeats, level: f64) -> Option<(f64, f64)> {
    let Repeats {
        pairs,
        count,
        followed,
        by_another,
    } = repeats;
    if p_value::drawn(by_another, followed, count.saturating_sub(1), pairs) >= level {
        return None;
    }
    let (tries, hits) = (followed as f64, by_another as f64);
    // Behind a run there is a fresh sample: no more than the share of repeats leaves room for.
    let fresh = (pairs - count) as f64;
    let run = (tries / (tries - hits)).max(count as f64 / fresh);
    // That of a share of successes, kept from zero.
    let again = (hits + 0.5) / (tries + 1.0);
    let again_sd = (again * (1.0 - again) / (tries + 1.0)).sqrt();
    Some((run, run * run * again_sd))
}

#[cfg(test)]
mod tests;
