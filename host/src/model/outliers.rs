//! Outliers: single samples that are far off.

use rand_distr::{Distribution, Exp1};
use rand_pcg::Pcg64;

use super::Seed;
use super::effect::{Distorter, Distortion, Effect, Incoming, Parameter, Part, Quantity, Stage};
use super::kind::Kind;
use super::marks::Mark;
use super::random::{self, Gaussian};
use crate::numeric::written::significant;

/// Impulses one sample long on top of what is there: at random times and of Gaussian height, or, where a record holds
/// few, the very ones that it holds.
///
/// They act behind the signal chain: one that came through a converter's filter would be as long
/// as the filter.
#[derive(Debug, Clone, PartialEq)]
pub struct Outliers {
    /// Impulses a second.
    pub rate_hz: f64,
    /// Root mean square of their heights, unit of the signal.
    pub size: f64,
    /// Those of a record that holds few: time since its start in seconds, and height in the unit of the signal. No
    /// others come then. Empty where they come at random.
    pub dated: Vec<(f64, f64)>,
}

impl Outliers {
    /// With these parameters, in the catalogue's order.
    pub fn of(values: &[f64]) -> Self {
        let dated = values[2..].chunks_exact(2).map(|row| (row[0], row[1]));
        Self {
            rate_hz: values[0],
            size: values[1],
            dated: dated.collect(),
        }
    }

    /// Two-sided density of theirs at a data rate of `rate_hz`. The number in a sample is Poisson distributed, so
    /// their sum has the variance `size^2` times their number a sample, and neighbours know nothing of each
    /// other.
    pub fn density(&self, rate_hz: f64) -> f64 {
        self.rate_hz * (self.size / rate_hz).powi(2)
    }
}

impl Distortion for Outliers {
    fn stage(&self) -> Stage {
        Stage::Sample
    }

    fn adds(&self, incoming: &Incoming<'_>) -> Vec<f64> {
        vec![self.density(incoming.rate_hz) * incoming.rate_hz]
    }

    fn distorter(&self, rate_hz: f64, seed: Seed) -> Box<dyn Distorter> {
        if !self.dated.is_empty() {
            return Box::new(Dated::new(&self.dated, rate_hz));
        }
        let mut impulses = Impulses {
            times: random::random(seed),
            heights: Gaussian::new(
                Seed {
                    stream: seed.stream + HEIGHTS,
                    ..seed
                },
                self.size,
            ),
            samples_between: rate_hz / self.rate_hz,
            next: 0,
            fraction: 0.0,
            index: 0,
        };
        impulses.wait();
        Box::new(impulses)
    }
}

/// Streams of random numbers further on that the heights take, out of reach of other effects.
const HEIGHTS: u64 = 1 << 32;

struct Impulses {
    times: Pcg64,
    heights: Gaussian,
    /// Mean distance, samples; infinite if there are none.
    samples_between: f64,
    /// Sample of the next impulse, and where between it and the following one.
    next: u64,
    fraction: f64,
    /// Index of the next sample.
    index: u64,
}

impl Impulses {
    fn wait(&mut self) {
        let pause: f64 = Exp1.sample(&mut self.times);
        let time = self.fraction + pause * self.samples_between;
        self.next = self.next.saturating_add(time as u64);
        self.fraction = time.fract();
    }
}

impl Distorter for Impulses {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        let end = self.index + samples.len() as u64;
        while self.next < end {
            samples[(self.next - self.index) as usize] += self.heights.draw();
            self.wait();
        }
        self.index = end;
    }
}

/// Impulses at known samples.
struct Dated {
    /// Sample and height of those to come, the next one last.
    to_come: Vec<(u64, f64)>,
    /// Index of the next sample.
    index: u64,
}

impl Dated {
    /// Each at the sample that is nearest to its time.
    fn new(dated: &[(f64, f64)], rate_hz: f64) -> Self {
        let sample = |&(time_s, height): &(f64, f64)| ((time_s * rate_hz).round() as u64, height);
        let mut to_come: Vec<(u64, f64)> = dated.iter().map(sample).collect();
        to_come.sort_by_key(|&(index, _)| std::cmp::Reverse(index));
        Self { to_come, index: 0 }
    }
}

impl Distorter for Dated {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        let end = self.index + samples.len() as u64;
        while let Some((index, height)) = self.to_come.pop_if(|(index, _)| *index < end) {
            samples[(index - self.index) as usize] += height;
        }
        self.index = end;
    }
}

/// Outliers in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "outliers"
    }

    fn meaning(&self) -> &'static str {
        "single samples that are far off: words torn on the wire, sparks and switching near the \
         board"
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let law = [
            Parameter::new("rate_hz", Quantity::PerSecond, "how many a second"),
            Parameter::new("size", Quantity::Signal, "root mean square height"),
        ];
        let row = |number| {
            [
                Parameter::new(
                    "time_s",
                    Quantity::Instant,
                    "when it comes, where a record holds few",
                )
                .in_row(number),
                Parameter::new(
                    "height",
                    Quantity::Signal,
                    "how much its sample is too large",
                )
                .in_row(number),
            ]
        };
        let dated = values.len().saturating_sub(law.len()).div_ceil(2);
        law.into_iter().chain((1..=dated).flat_map(row)).collect()
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let dated = Outliers::of(values).dated.into_iter();
        dated.map(|(time_s, _)| Mark::Moment(time_s)).collect()
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "short the converter's input: outliers that still come, {} a second, are words \
             torn on the way to the host, so look at their codes for shifted bits; else look for \
             what switches near the sensor",
            significant(values[0], 4)
        )
    }

    fn size(&self) -> Option<usize> {
        Some(1)
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Outliers::of(values)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::trial;

    #[test]
    fn are_as_many_and_as_large_as_told() {
        let (rate_hz, count, seed) = (1000.0, 400_000, 11);
        let outliers = Outliers {
            rate_hz: 20.0,
            size: 3.0,
            dated: Vec::new(),
        };
        let mut samples = vec![0.0; count];
        outliers
            .distorter(rate_hz, Seed { seed, stream: 0 })
            .apply(&mut samples);
        let count = count as f64;
        let mean = outliers.rate_hz / rate_hz;
        let hit = -(-mean).exp_m1();
        let found = samples.iter().filter(|&&x| x != 0.0).count() as f64;
        let z = (found - count * hit) / (count * hit * (1.0 - hit)).sqrt();
        assert!(z.abs() < 5.0, "seed {seed}: {found}, {z} sigma");
        // A Poisson sum of Gaussian numbers: fourth moment 3 s^4 (mean + mean^2).
        let power = mean * outliers.size.powi(2);
        let fourth = 3.0 * outliers.size.powi(4) * (mean + mean * mean);
        let square = samples.iter().map(|x| x * x).sum::<f64>() / count;
        let z = (square - power) / ((fourth - power * power) / count).sqrt();
        assert!(
            z.abs() < 5.0,
            "seed {seed}: {square} for {power}, {z} sigma"
        );
    }

    #[test]
    fn allan_variance_follows_the_law() {
        let outliers = r#"{ "effect": "outliers", "parameters": { "rate_hz": 200, "size": 3 } }"#;
        let axis = trial::axis(r#""N": 0.01"#, outliers);
        trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 7, 64]);
    }

    #[test]
    fn dated_ones_come_where_they_were_and_no_others() {
        let outliers = Outliers::of(&[0.2, 3.0, 0.0, 5.0, 0.0105, -2.0, 0.004, 1.0]);
        let seed = Seed { seed: 1, stream: 0 };
        for block in [1, 3, 7, 20] {
            let mut distorter = outliers.distorter(1000.0, seed);
            let mut record = Vec::new();
            while record.len() < 20 {
                let mut samples = vec![0.0; block.min(20 - record.len())];
                distorter.apply(&mut samples);
                record.extend(samples);
            }
            let found: Vec<(usize, f64)> = (0..20)
                .map(|n| (n, record[n]))
                .filter(|one| one.1 != 0.0)
                .collect();
            assert_eq!(found, [(0, 5.0), (4, 1.0), (11, -2.0)], "blocks of {block}");
        }
    }

    #[test]
    fn none_come_at_rate_zero() {
        let outliers = Outliers {
            rate_hz: 0.0,
            size: 3.0,
            dated: Vec::new(),
        };
        let mut samples = vec![0.0; 1000];
        let seed = Seed { seed: 1, stream: 0 };
        outliers.distorter(1000.0, seed).apply(&mut samples);
        assert!(samples.iter().all(|&x| x == 0.0));
    }
}
