//! Stale samples: a sample repeats the one before.

use std::f64::consts::{PI, TAU};

use rand_distr::{Bernoulli, Distribution};
use rand_pcg::Pcg64;

use super::Seed;
use super::effect::{Distorter, Distortion, Effect, Incoming, Parameter, Part, Quantity, Stage};
use super::kernel;
use super::kind::Kind;
use super::random;

/// Samples that repeat the one before: by chance, whatever happened before, or in runs.
///
/// A fresh sample is followed by a repeat with the chance `p`, a repeat by another with `q`, so that the share
/// `s = p / (1 - q + p)` of the samples repeats, `1 / (1 - q)` of them in a row on average. A sample read at `k` is of the
/// age `a`: `y_k = x_(k-a)`. Ages have a mean filter, and `y` is what that lets through and noise that knows nothing of it,
/// as what an age is off by is independent of the input:
///
/// ```text
/// P(a = 0) = 1 - s,  P(a) = (1 - s) p q^(a-1)
/// H(z) = (1 - s) (1 - (q - p) z^-1) / (1 - q z^-1)
/// <w_k w_(k+m)> = -1/2 (<D(m - a' + a)> - the same with ages that know nothing of each other)
/// ```
///
/// with `a'` the age at `k + m` and `D(j) = <(x_(k+j) - x_k)^2>`, which walks and flicker have too: the weights of
/// both means have the same sum and the same first moment. Without a memory, `q = p = s`, this is the recursive filter
/// `y_k = s y_(k-1) + (1 - s) x_k + w_k` with white `w`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stale {
    /// Share of samples that repeat the one before.
    pub share: f64,
    /// Repeats in a row on average, 1 or more; zero where a repeat tells nothing of the next sample.
    pub run_samples: f64,
}

/// Part of what a repeat tells of those behind it that is left where it counts as nothing: far below the sixth digit of a law.
const FORGOTTEN: f64 = 1e-9;

/// Samples over which the noise of repeats is followed, at most. Runs of 50 on average are forgotten to [`FORGOTTEN`] by then;
/// longer ones to that less, at a tenth of a second for each law.
const MEMORY: usize = 1024;

impl Stale {
    /// With these parameters, in the catalogue's order.
    fn of(values: &[f64]) -> Self {
        Self {
            share: values[0],
            run_samples: values.get(1).copied().unwrap_or(0.0),
        }
    }

    /// Chance that a repeat is followed by another.
    fn again(&self) -> f64 {
        if self.run_samples == 0.0 {
            self.share
        } else {
            1.0 - 1.0 / self.run_samples
        }
    }

    /// Chance that a fresh sample is followed by a repeat.
    fn first(&self) -> f64 {
        if self.share >= 1.0 {
            return 1.0;
        }
        self.share * (1.0 - self.again()) / (1.0 - self.share)
    }

    /// Share of the samples that are so many samples old, from zero on, as far as it matters.
    fn ages(&self) -> Vec<f64> {
        let again = self.again();
        let memory = again.max((again - self.first()).abs());
        let count = (FORGOTTEN.ln() / memory.ln()).ceil().max(2.0);
        let repeats = std::iter::successors(Some(self.first()), |chance| Some(chance * again));
        let ages = std::iter::once(1.0).chain(repeats);
        ages.map(|chance| (1.0 - self.share) * chance)
            .take((count as usize).min(MEMORY))
            .collect()
    }

    /// Autocovariances of the noise, where the input moves by `moved[j]` in mean square over `j` samples, known over twice as
    /// many as there are `ages`.
    fn autocovariances(&self, ages: &[f64], moved: &[f64]) -> Vec<f64> {
        let (first, again) = (self.first(), self.again());
        let older = |j: usize| -> f64 {
            let repeats = ages.iter().enumerate().skip(1);
            repeats.map(|(age, share)| share * moved[j + age]).sum()
        };
        // The first fresh sample or a later one is j samples behind a fresh one, or behind a repeat.
        let renewed: Vec<f64> = (0..ages.len())
            .scan(1.0, |kept, j| {
                let behind_fresh = 1.0 - self.share * (1.0 - *kept);
                let behind_repeat = (1.0 - self.share) * (1.0 - *kept);
                *kept *= again - first;
                Some(behind_fresh * (1.0 - self.share) * moved[j] + behind_repeat * older(j))
            })
            .collect();
        let apart = differences(ages);
        let autocovariance = |m: usize| {
            let unbroken = ages[..m].iter().map(|share| share / (1.0 - self.share));
            let together: f64 = (0..m)
                .map(|n| m - n)
                .zip(unbroken)
                .map(|(j, kept)| kept * renewed[j])
                .sum();
            let by_themselves = |(d, share): (usize, &f64)| {
                let both = moved[m + d] + moved[m.abs_diff(d)];
                share * if d == 0 { 0.5 * both } else { both }
            };
            let by_themselves: f64 = apart.iter().enumerate().map(by_themselves).sum();
            0.5 * (by_themselves - together)
        };
        (0..ages.len()).map(autocovariance).collect()
    }
}

/// How often two ages that know nothing of each other differ by so much, either way.
fn differences(ages: &[f64]) -> Vec<f64> {
    let by = |d: usize| ages.iter().zip(&ages[d..]).map(|(a, b)| a * b).sum();
    (0..ages.len()).map(by).collect()
}

impl Distortion for Stale {
    fn stage(&self) -> Stage {
        Stage::Reading
    }

    fn power(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let (first, again) = (self.first(), self.again());
        let sine = (PI * f_hz / rate_hz).sin();
        // |1 - r z^-1|^2
        let distance = |r: f64| (1.0 - r).powi(2) + 4.0 * r * sine * sine;
        (1.0 - self.share).powi(2) * distance(again - first) / distance(again)
    }

    fn adds(&self, incoming: &Incoming<'_>) -> Vec<f64> {
        if self.share >= 1.0 {
            // Nothing but the first sample.
            return Vec::new();
        }
        let ages = self.ages();
        self.autocovariances(&ages, &moved(incoming, 2 * ages.len()))
    }

    fn distorter(&self, _rate_hz: f64, seed: Seed) -> Box<dyn Distorter> {
        let chance = |chance| Bernoulli::new(chance).expect("a share");
        Box::new(Repeater {
            random: random::random(seed),
            first: chance(self.first()),
            again: chance(self.again()),
            last: None,
            is_repeat: false,
        })
    }
}

/// Mean square by which a signal moves over 0 samples, 1, and so on, `count` numbers.
fn moved(incoming: &Incoming<'_>, count: usize) -> Vec<f64> {
    let mut moved = kernel::moved(count, incoming.rate_hz, |f_hz| (incoming.density)(f_hz));
    for line in incoming.lines {
        let steps = kernel::one_less_cosine(TAU * line.f_hz / incoming.rate_hz);
        for (sum, step) in moved.iter_mut().zip(steps) {
            *sum += 2.0 * line.power * step;
        }
    }
    moved
}

struct Repeater {
    random: Pcg64,
    first: Bernoulli,
    again: Bernoulli,
    last: Option<f64>,
    is_repeat: bool,
}

impl Distorter for Repeater {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        for sample in samples {
            let chance = if self.is_repeat {
                self.again
            } else {
                self.first
            };
            let drawn = chance.sample(&mut self.random);
            self.is_repeat = drawn && self.last.is_some();
            if let (true, Some(last)) = (self.is_repeat, self.last) {
                *sample = last;
            }
            self.last = Some(*sample);
        }
    }
}

/// Stale samples in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "stale"
    }

    fn meaning(&self) -> &'static str {
        "samples that repeat the one before: the reader was faster than the converter, or missed \
         a ready signal"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new(
                "share",
                Quantity::Share,
                "part of the samples that repeat the one before",
            ),
            Parameter::new(
                "run_samples",
                Quantity::Ratio,
                "repeats in a row on average; zero where a repeat tells nothing of the next sample",
            )
            .or_zero(),
        ]
    }

    /// Between two runs there is a fresh sample at least.
    fn is_sound(&self, values: &[f64]) -> bool {
        let stale = Stale::of(values);
        stale.run_samples == 0.0 || stale.run_samples >= 1.0 && stale.first() <= 1.0
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "compare the converter's clock with the reader's: {:.3} % of the samples are read \
             twice; read on the converter's ready signal, and count those that are missed",
            100.0 * values[0]
        )
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Stale::of(values)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::trial;

    #[test]
    fn as_many_repeat_as_told() {
        let seed = 4;
        let stale = Stale {
            share: 0.07,
            run_samples: 0.0,
        };
        let mut samples: Vec<f64> = (0..100_000).map(f64::from).collect();
        stale
            .distorter(1.0, Seed { seed, stream: 0 })
            .apply(&mut samples);
        let pairs = (samples.len() - 1) as f64;
        let found = samples.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64;
        let sigma = (pairs * stale.share * (1.0 - stale.share)).sqrt();
        let z = (found - pairs * stale.share) / sigma;
        assert!(z.abs() < 5.0, "seed {seed}: {found}, {z} sigma");
        // What is fresh is on time.
        let fresh = (0_u32..).zip(&samples).filter(|&(k, &x)| x == f64::from(k));
        assert_eq!(fresh.count() as f64, pairs + 1.0 - found);
    }

    #[test]
    fn runs_are_as_long_and_as_many_as_told() {
        let seed = 5;
        // The last one: nothing but pairs, every other sample but a few.
        for (share, run_samples) in [(0.07, 4.0), (0.6, 3.0), (0.01, 50.0), (0.45, 1.0)] {
            let stale = Stale { share, run_samples };
            let mut samples: Vec<f64> = (0..400_000).map(f64::from).collect();
            stale
                .distorter(1.0, Seed { seed, stream: 0 })
                .apply(&mut samples);
            let repeats: Vec<bool> = samples.windows(2).map(|pair| pair[0] == pair[1]).collect();
            let found = repeats.iter().filter(|&&repeat| repeat).count() as f64;
            let runs = repeats.chunk_by(|a, b| a == b).filter(|run| run[0]).count() as f64;
            // Lengths are geometric, of a deviation of the root of (1 - 1/run) run.
            let spread = (1.0 - 1.0 / run_samples).sqrt() * run_samples / runs.sqrt();
            let off = found / runs - run_samples;
            assert!(
                off.abs() <= 5.0 * spread + 1e-12,
                "seed {seed}, {stale:?}: {off}"
            );
            // A share of runs varies by what their number does, and by their lengths: at most 2 of both.
            let spread = share * (2.0 / runs).sqrt();
            let off = found / repeats.len() as f64 - share;
            assert!(off.abs() < 5.0 * spread, "seed {seed}, {stale:?}: {off}");
        }
    }

    /// Where a repeat tells nothing of the next sample, ages have a closed form and the noise is white.
    #[test]
    fn noise_of_repeats_without_a_memory_is_white() {
        let density = |f_hz: f64| 0.02 + 1.0 / f_hz.powi(2);
        let incoming = Incoming {
            rate_hz: 100.0,
            density: &density,
            lines: &[],
        };
        for share in [0.05, 0.6, 0.9] {
            let stale = |run_samples| Stale { share, run_samples };
            let plain = stale(0.0).adds(&incoming);
            // <w^2> = s (1 - s) <(x_k - y_(k-1))^2>, and y_(k-1) is of a geometric age.
            let moved = kernel::moved(400, 100.0, density);
            let step: f64 = (0_i32..)
                .zip(&moved[1..])
                .map(|(age, moved)| share.powi(age) * (1.0 - share) * moved)
                .sum();
            // Behind the filter y_k = s y_(k-1) + ... it has the autocovariances of a first-order process.
            for (m, value) in (0_i32..).zip(&plain) {
                let expected = share / (1.0 + share) * step * share.powi(m);
                assert!(
                    (value - expected).abs() < 1e-6 * plain[0],
                    "share {share}, lag {m}: {value}, {expected}"
                );
            }
            let in_runs = stale(1.0 / (1.0 - share)).adds(&incoming);
            let same = plain.iter().zip(&in_runs);
            assert!(
                same.into_iter()
                    .all(|(a, b)| (a - b).abs() < 1e-9 * plain[0])
            );
        }
    }

    #[test]
    fn allan_variance_follows_the_law() {
        for (share, run_samples) in [
            (0.05, 0.0),
            (0.6, 0.0),
            (0.05, 4.0),
            (0.6, 3.0),
            (0.45, 1.0),
        ] {
            let effects = format!(
                r#"{{ "effect": "sinusoid", "parameters": {{ "f_hz": 230, "amplitude": 0.5 }} }},
                   {{ "effect": "stale", "parameters":
                       {{ "share": {share}, "run_samples": {run_samples} }} }}"#
            );
            // Each of about the same size at one sample.
            let axis = trial::axis(r#""N": 0.02, "K": 20, "Q": 4e-4"#, &effects);
            trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 3, 8, 30]);
        }
    }
}
