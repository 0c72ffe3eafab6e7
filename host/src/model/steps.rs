//! Steps: the level jumps and stays.

use super::Seed;
use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::once::Once;
use super::random::Generator;
use crate::numeric::written::significant;

/// Jumps of the level at given times. Not random, and no two records have them alike: what they
/// add to an Allan variance depends on where in the record they are, so the law says zero. Whoever
/// knows the record takes out the course that the generator makes, which no seed changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Steps(
    /// Each jump: its time in seconds since the start, and its height in the unit of the signal.
    pub Vec<(f64, f64)>,
);

impl Once for Steps {
    /// A chain would round the edges off over a few samples; they stay sharp.
    fn drifts(&self) -> bool {
        true
    }

    fn course(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Generator> {
        /// Samples by which a time may be late for rounding.
        const LATE: f64 = 1e-3;
        // The first sample at or after the time is the first at the new level.
        let first = |time_s: f64| (time_s * rate_hz - LATE).ceil().max(0.0) as u64;
        let jump = |&(time_s, height): &(f64, f64)| (first(time_s), height);
        Box::new(Staircase::new(self.0.iter().map(jump)))
    }
}

/// The course of some jumps, sample by sample from the first.
pub struct Staircase {
    /// Those to come, the next one last.
    jumps: Vec<(u64, f64)>,
    index: u64,
    level: f64,
}

impl Staircase {
    /// Of jumps, each with the first sample at its new level and its height.
    pub fn new(jumps: impl IntoIterator<Item = (u64, f64)>) -> Self {
        let mut jumps: Vec<(u64, f64)> = jumps.into_iter().collect();
        jumps.sort_by_key(|&(index, _)| std::cmp::Reverse(index));
        Self {
            jumps,
            index: 0,
            level: 0.0,
        }
    }
}

impl Generator for Staircase {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            while let Some((_, height)) = self.jumps.pop_if(|(index, _)| *index <= self.index) {
                self.level += height;
            }
            *sample += self.level;
            self.index += 1;
        }
    }
}

/// Steps in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "steps"
    }

    fn meaning(&self) -> &'static str {
        "the level jumps and stays: the block was moved or settled, a solder joint or glue gave \
         way, the supply or the range was switched"
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let row = |number| {
            [
                Parameter::new("time_s", Quantity::Instant, "when it jumps").in_row(number),
                Parameter::new("height", Quantity::Signal, "new level less the old one")
                    .in_row(number),
            ]
        };
        (1..=values.len().div_ceil(2).max(1))
            .flat_map(row)
            .collect()
    }

    fn check(&self, values: &[f64]) -> String {
        let largest = values
            .chunks_exact(2)
            .max_by(|a, b| a[1].abs().total_cmp(&b[1].abs()))
            .expect("at least one step");
        format!(
            "recall what happened {:.2} s into the record, at the largest step of {}; jumps in \
             all axes at once are the block or the supply, jumps in one are its sensor or joint",
            largest[0],
            significant(largest[1], 4)
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let rows = values.chunks_exact(2);
        rows.map(|row| Mark::Moment(row[0])).collect()
    }

    fn part(&self, values: &[f64]) -> Part {
        let steps = values.chunks_exact(2).map(|row| (row[0], row[1]));
        Part::Term(Box::new(Steps(steps.collect())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_is_the_sum_of_the_jumps_so_far() {
        let steps = Steps(vec![(0.3, 2.0), (0.1, -1.0), (0.3, 0.5), (7.0, 9.0)]);
        let mut samples = vec![1.0; 1000];
        let seed = Seed { seed: 1, stream: 0 };
        steps.course(2000.0, seed).add_to(&mut samples);
        let levels: Vec<(usize, f64)> = samples
            .chunk_by(|a, b| a == b)
            .map(|run| (run.len(), run[0]))
            .collect();
        assert_eq!(levels, [(200, 1.0), (400, 0.0), (400, 2.5)]);
    }

    #[test]
    fn a_step_between_two_samples_begins_with_the_later_one() {
        // Every moment that rounds down or up on its way through seconds, and half a sample before it.
        for first in 1..3000_u32 {
            for late in [0.0, 0.5, 0.99] {
                let time_s = (f64::from(first) - late) / 1999.7;
                let steps = Steps(vec![(time_s, 1.0)]);
                let mut samples = vec![0.0; 3001];
                let seed = Seed { seed: 1, stream: 0 };
                steps.course(1999.7, seed).add_to(&mut samples);
                let before = samples.iter().take_while(|sample| **sample == 0.0);
                assert_eq!(before.count(), first as usize, "{late} of a sample");
            }
        }
    }
}
