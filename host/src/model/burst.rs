//! Burst: for a while the noise is larger, or smaller.

use std::f64::consts::TAU;

use super::Seed;
use super::effect::{Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::kind::Kind;
use super::marks::Mark;

/// Between two times what varies is multiplied, the level is not.
///
/// The level is a running mean: what is slower than the time that it is taken over stays as it is. How much a burst adds to a spectrum depends on its share `s` of the record,
/// `1 + s (factor^2 - 1)` above one over that time; without a record the law leaves it at 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Burst {
    /// Start, seconds since that of the record.
    pub from_s: f64,
    /// End, seconds since the start of the record; no burst if it is not after the start.
    pub to_s: f64,
    /// Factor on the standard deviation of the noise.
    pub factor: f64,
    /// Time that the level is averaged over, seconds; zero for as long as the burst lasts.
    pub level_s: f64,
}

impl Burst {
    /// With these parameters, in the catalogue's order.
    pub fn of(values: &[f64]) -> Self {
        Self {
            from_s: values[0],
            to_s: values[1],
            factor: values[2],
            level_s: values.get(3).copied().unwrap_or(0.0),
        }
    }

    /// Time that the level is averaged over, seconds.
    pub fn averages_s(&self) -> f64 {
        if self.level_s > 0.0 {
            self.level_s
        } else {
            self.to_s - self.from_s
        }
    }

    /// Power that passes as fluctuation about the level: what is left of a frequency without its running mean, whose
    /// memory fades exponentially.
    pub fn passes(&self, f_hz: f64) -> f64 {
        let turns = (TAU * f_hz * self.averages_s()).powi(2);
        turns / (1.0 + turns)
    }

    /// What it adds to the power of noise that is faster than it lasts, as a share, in the mean over a record of this
    /// length, seconds; negative where the noise is quieter.
    pub fn adds(&self, record_s: f64) -> f64 {
        (self.to_s - self.from_s) / record_s * (self.factor.powi(2) - 1.0)
    }
}

impl Distortion for Burst {
    fn stage(&self) -> Stage {
        Stage::Noise
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        let index = |time_s: f64| (time_s * rate_hz).round() as u64;
        let (from, to) = (index(self.from_s), index(self.to_s));
        Box::new(Louder {
            factor: self.factor,
            from,
            to,
            memory: (self.averages_s() * rate_hz).round().max(1.0),
            index: 0,
            level: 0.0,
        })
    }
}

struct Louder {
    factor: f64,
    from: u64,
    to: u64,
    /// Samples over which the level is averaged.
    memory: f64,
    index: u64,
    level: f64,
}

impl Distorter for Louder {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        for sample in samples {
            // The plain mean of what there is, until that is long enough.
            let known = (self.index as f64 + 1.0).min(self.memory);
            self.level += (*sample - self.level) / known;
            if (self.from..self.to).contains(&self.index) {
                *sample = self.level + self.factor * (*sample - self.level);
            }
            self.index += 1;
        }
    }
}

/// Burst in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "burst"
    }

    fn meaning(&self) -> &'static str {
        "for a while the noise is larger or smaller at the same level: steps on the floor, a \
         machine that ran, a supply that was in trouble"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("from_s", Quantity::Instant, "start"),
            Parameter::new("to_s", Quantity::Instant, "end"),
            Parameter::new(
                "factor",
                Quantity::Factor,
                "on the standard deviation of the noise",
            ),
            Parameter::new(
                "level_s",
                Quantity::SecondOrNone,
                "time that the level is averaged over; as long as the burst where it is not given",
            )
            .or_zero(),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "recall what went on from {:.2} s to {:.2} s, and compare the spectrum of that part \
             (--from, --to) with the rest: peaks are machines, more of everything is the supply",
            values[0], values[1]
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        vec![Mark::Stretch(values[0], values[1])]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Burst::of(values)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::{Gaussian, Generator};

    #[test]
    fn multiplies_the_noise_and_not_the_level() {
        let burst = Burst {
            from_s: 20.0,
            to_s: 50.0,
            factor: 3.0,
            level_s: 0.0,
        };
        let seed = Seed { seed: 9, stream: 0 };
        let mut samples = vec![9.8; 100_000];
        Gaussian::new(seed, 1.0).add_to(&mut samples);
        let plain = samples.clone();
        burst.distorter(1000.0, seed).apply(&mut samples);
        assert!(plain[..20_000] == samples[..20_000] && plain[50_000..] == samples[50_000..]);
        let inside = &samples[20_000..50_000];
        let count = inside.len() as f64;
        let mean = inside.iter().sum::<f64>() / count;
        let variance = inside.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
        // factor times the samples' mean less factor - 1 times the level's, of as many samples.
        let sigma = f64::hypot(burst.factor, burst.factor - 1.0) / count.sqrt();
        let z = (mean - 9.8) / sigma;
        assert!(z.abs() < 5.0, "{seed:?}: mean {mean}, {z} sigma");
        let z = (variance / burst.factor.powi(2) - 1.0) / (2.0 / count).sqrt();
        assert!(z.abs() < 5.0, "{seed:?}: variance {variance}, {z} sigma");
    }

    #[test]
    fn what_is_slower_than_its_level_stays_as_it_is() {
        let burst = Burst {
            from_s: 20.0,
            to_s: 50.0,
            factor: 100.0,
            level_s: 0.01,
        };
        let slow = |n: usize| (TAU * 0.05 * n as f64 / 1000.0).sin();
        let mut samples: Vec<f64> = (0..60_000).map(slow).collect();
        let seed = Seed { seed: 3, stream: 0 };
        burst.distorter(1000.0, seed).apply(&mut samples);
        // A running mean lags by its own time: 0.3 % of the sine, a hundred times as large.
        let passes = burst.passes(0.05).sqrt() * 99.0;
        let off = |n: usize| (samples[n] - slow(n)).abs();
        let most = (20_500..50_000).map(off).fold(0.0, f64::max);
        assert!((most / passes - 1.0).abs() < 0.1, "{most} of {passes}");
    }

    #[test]
    fn none_where_it_ends_before_it_starts() {
        let burst = Burst {
            from_s: 5.0,
            to_s: 2.0,
            factor: 3.0,
            level_s: 0.0,
        };
        let seed = Seed { seed: 1, stream: 0 };
        let mut samples: Vec<f64> = (0..10).map(f64::from).collect();
        burst.distorter(1.0, seed).apply(&mut samples);
        assert_eq!(samples, (0..10).map(f64::from).collect::<Vec<f64>>());
    }
}
