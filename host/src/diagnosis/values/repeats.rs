//! Samples that repeat the one before, more often than chance has it.
//!
//! How often chance has it is read off the increments next to zero. On a coarse grid, of which the
//! noise spans a few steps, those of one and two steps determine it: for normal increments `ln p(k)` is a
//! parabola in `k`, so `p(0) = p(1) (p(1) / p(2))^(1/3)`. On a fine one the density of increments is even
//! there: with `c` of them within `m` steps on either side, zero itself has `c / 2m`. A long record of
//! fine codes repeats itself a few times an hour.

use crate::diagnosis::statistic::p_value;

/// Increments next to zero from which the density there is estimated, at least: it is then known to
/// an eighth.
const LEAST_INCREMENTS: usize = 64;

/// Numbers of steps that the smallest increment may be, where nobody declared the step: a choice.
const SMALLEST: u32 = 8;

/// How far from a whole number of steps an increment may be: by the rounding of a file's numbers.
const WHOLE: f64 = 0.01;

/// Repeats that are no sign of anything, on values of no grid: the least there is to divide by.
const NEVER: f64 = 1e-3;

/// Repeats from which their number is as good as normal: its skewness is 0.03.
const MANY: f64 = 1000.0;

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

/// Repeats that chance has in a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chance {
    /// Expected number of repeats.
    pub count: f64,
    /// Variance of this expectation, for what it is read off is a count itself.
    pub variance: f64,
}

impl Chance {
    /// Of values on a `grid` whose steps the noise spans by a few; `increments` are all that there are.
    pub fn on_grid(increments: &[f64], grid: f64) -> Self {
        let at = |steps: f64| {
            let near = |step: &&f64| (step.abs() / grid - steps).abs() < 0.5;
            0.5 * increments.iter().filter(near).count() as f64
        };
        let (one, two) = (at(1.0), at(2.0));
        let count = if one > 0.0 && two > 0.0 {
            one * (one / two).cbrt()
        } else {
            at(0.0) * 2.0
        };
        Self {
            count,
            variance: 1.2 * count,
        }
    }

    /// Of values that lie closer than can be counted; `noise` is the deviation of one increment over
    /// the root of two, `step` that of the codes, where it is declared.
    pub fn between(increments: &[f64], noise: f64, step: Option<f64>) -> Self {
        let never = Self {
            count: NEVER,
            variance: 0.0,
        };
        let mut reach = noise * LEAST_INCREMENTS as f64 / increments.len().max(1) as f64;
        let mut near: Vec<f64>;
        loop {
            let sizes = increments.iter().map(|step| step.abs());
            near = sizes.filter(|&size| size > 0.0 && size <= reach).collect();
            if near.len() >= LEAST_INCREMENTS {
                break;
            }
            // Also where there is no noise to measure by.
            if reach.is_nan() || reach <= 0.0 || reach > noise {
                return never;
            }
            reach *= 2.0;
        }
        let Some(step) = step.or_else(|| common_step(&near)) else {
            return never;
        };
        let steps = (reach / step + WHOLE).floor();
        if steps < 1.0 {
            return never;
        }
        let count = near.len() as f64 / (2.0 * steps);
        Self {
            count,
            variance: count * count / near.len() as f64,
        }
    }

    /// Probability of so many repeats or more.
    fn exceeded(&self, repeats: f64) -> f64 {
        if repeats + self.count > MANY {
            let beyond = (repeats - self.count) / (self.count + self.variance).sqrt();
            return 0.5 * p_value::two_sided(beyond.max(0.0));
        }
        p_value::counted(repeats as u64, self.count, self.variance)
    }
}

/// The step that all of these sizes are multiples of, where the smallest is but a few of it.
fn common_step(sizes: &[f64]) -> Option<f64> {
    let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let parts = (1..=SMALLEST).map(|number| smallest / f64::from(number));
    let fits = |step: &f64| {
        let whole = |size: &f64| ((size / step).round() - size / step).abs() < WHOLE;
        sizes.iter().all(whole)
    };
    parts.into_iter().find(fits)
}

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
mod tests {
    use super::*;
    use crate::model::axis::ModelEffect;
    use crate::model::effect::Part;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    const LENGTH: usize = 1 << 18;

    /// White noise of a deviation of `sd` steps of size `step`; every `every`-th sample repeats.
    fn increments(seed: u64, sd: f64, step: f64, every: usize) -> Vec<f64> {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, sd);
        let mut values: Vec<f64> = Vec::with_capacity(LENGTH);
        for n in 0..LENGTH {
            let drawn = step * noise.draw().round();
            values.push(if n % every == every - 1 {
                values[n - 1]
            } else {
                drawn
            });
        }
        values.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    fn found(increments: &[f64], chance: Chance, level: f64) -> Option<Stale> {
        let repeats = (1..).zip(increments).filter(|(_, step)| **step == 0.0);
        let places: Vec<usize> = repeats.map(|(place, _)| place).collect();
        let measured = vec![0.0; increments.len() + 1];
        stale(Repeats::new(&measured, &places), chance, level)
    }

    fn spread(increments: &[f64]) -> f64 {
        let squares: f64 = increments.iter().map(|step| step * step).sum();
        (0.5 * squares / increments.len() as f64).sqrt()
    }

    #[test]
    fn fine_codes_repeat_by_chance() {
        // Deviations from 3000 to 300 000 steps: 25 to 0.25 repeats by chance, 1 / (2 sd sqrt pi) a pair.
        for sd in [3e3, 2e4, 3e5] {
            let expected = LENGTH as f64 / (2.0 * sd * std::f64::consts::PI.sqrt());
            for declared in [Some(0.5), None] {
                let mut alarms = Vec::new();
                for seed in 0..40 {
                    let steps = increments(seed, sd, 0.5, usize::MAX);
                    let chance = Chance::between(&steps, spread(&steps), declared);
                    // Read off some 64 to 128 increments: 5 standard deviations of 12.5 %; and
                    // without a declared step a smallest increment of more than eight is none.
                    let ratio = chance.count / expected;
                    let is_none = declared.is_none() && chance.count == NEVER;
                    assert!(
                        (0.4..1.65).contains(&ratio) || is_none,
                        "sd {sd}, seed {seed}: {chance:?}, {expected} expected"
                    );
                    if found(&steps, chance, 0.005).is_some() {
                        alarms.push(seed);
                    }
                }
                // 0.2 expected; 3 or more have a probability of 1e-3.
                assert!(alarms.len() < 3, "sd {sd}: seeds {alarms:?}");
            }
        }
    }

    #[test]
    fn a_number_of_known_mean_is_poisson_and_a_guessed_one_wider() {
        let of = |variance| Chance {
            count: 2.0,
            variance,
        };
        // 1 - e^-2 (1 + 2 + 2 + 4/3 + 2/3 + 4/15 + 4/45 + 8/315)
        let known = of(0.0).exceeded(8.0);
        assert!((known - 1.0967e-3).abs() < 1e-6, "{known}");
        let nearly = of(1e-4).exceeded(8.0);
        assert!((nearly / known - 1.0).abs() < 0.01, "{nearly}");
        assert!(of(1.0).exceeded(8.0) > 2.0 * known);
    }

    #[test]
    fn repeats_beyond_chance_are_told_with_their_share() {
        for declared in [Some(0.5), None] {
            let steps = increments(1, 2e4, 0.5, 4096);
            let chance = Chance::between(&steps, spread(&steps), declared);
            let found = found(&steps, chance, 2e-4).expect("64 repeats where 3.7 are chance");
            let share = 1.0 / 4096.0;
            let error = (found.share - share).abs() / found.share_sd;
            assert!(error < 4.0, "{found:?}");
        }
    }

    #[test]
    fn two_repeats_are_none_however_rare() {
        let chance = Chance {
            count: NEVER,
            variance: 0.0,
        };
        let apart = |count| Repeats {
            pairs: LENGTH,
            count,
            followed: count,
            by_another: 0,
        };
        assert!(stale(apart(2), chance, 1e-4).is_none());
        assert!(stale(apart(3), chance, 1e-4).is_some());
    }

    /// Samples that repeat the one before, as the effect draws them; what lies beyond so many deviations is missing.
    fn repeats(share: f64, run_samples: f64, beyond: f64, seed: u64) -> Option<Stale> {
        let effect = ModelEffect::new(
            "stale",
            &[("share", share), ("run_samples", run_samples)]
                .map(|(name, value)| (name.to_owned(), value))
                .into(),
        );
        let Part::Distortion(effect) = effect.expect("sound").part() else {
            panic!("a distortion")
        };
        let mut samples: Vec<f64> = (0..1 << 16).map(f64::from).collect();
        effect
            .distorter(1.0, Seed { seed, stream: 0 })
            .apply(&mut samples);
        let mut normal = Gaussian::new(Seed { seed, stream: 1 }, 1.0);
        for sample in &mut samples {
            *sample = if normal.draw() > beyond {
                f64::NAN
            } else {
                *sample
            };
        }
        let places: Vec<usize> = (1..samples.len())
            .filter(|&n| samples[n] == samples[n - 1])
            .collect();
        let never = Chance {
            count: NEVER,
            variance: 0.0,
        };
        stale(Repeats::new(&samples, &places), never, 1e-4)
    }

    #[test]
    fn runs_are_told_from_repeats_without_a_memory() {
        // None, a tenth and three tenths of a normal law lie beyond these.
        let (none, tenth, third) = (f64::INFINITY, 1.282, 0.524);
        for (share, run_samples, beyond) in [
            (0.002, 4.0, none),
            (0.05, 1.5, tenth),
            (0.3, 1.0, none),
            (0.6, 12.0, third),
        ] {
            let (mut off, mut share_off) = (Vec::new(), Vec::new());
            for seed in 0..100 {
                let found = repeats(share, run_samples, beyond, seed).expect("130 repeats or more");
                let (run, sd) = found.run_samples.expect("far from those without a memory");
                off.push((run - run_samples) / sd);
                share_off.push((found.share - share) / found.share_sd);
            }
            for off in [off, share_off] {
                // Deviations know themselves to a tenth for the shortest, and a share of 0.6 is overstated: none of 100 beyond 5.
                let worst = off.iter().fold(0.0, |most: f64, off| most.max(off.abs()));
                assert!(
                    worst < 5.0,
                    "{share}, {run_samples}, seeds 0 to 99: {worst}"
                );
            }
        }
        for share in [1e-3, 0.05, 0.5] {
            let told = |seed| {
                repeats(share, 0.0, tenth, seed)
                    .expect("60 repeats")
                    .run_samples
            };
            let wrong = (0..200).filter(|&seed| told(seed).is_some()).count();
            // 0.02 expected of 200 at 1e-4.
            assert!(wrong < 2, "{share}, seeds 0 to 199: {wrong}");
        }
    }

    #[test]
    fn values_between_the_codes_that_are_declared_never_repeat() {
        let mut noise = Gaussian::new(Seed { seed: 4, stream: 0 }, 1.0);
        let steps: Vec<f64> = (0..LENGTH).map(|_| noise.draw()).collect();
        let chance = Chance::between(&steps, 1.0, Some(100.0));
        assert_eq!(chance.count, NEVER, "seed 4");
    }

    #[test]
    fn values_of_no_grid_never_repeat() {
        let mut noise = Gaussian::new(Seed { seed: 3, stream: 0 }, 1.0);
        let steps: Vec<f64> = (0..LENGTH).map(|_| noise.draw()).collect();
        assert_eq!(Chance::between(&steps, 1.0, None).count, NEVER);
    }
}
