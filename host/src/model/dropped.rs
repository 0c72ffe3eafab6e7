//! Dropped samples: some are missing, and nothing says so.

use super::Seed;
use super::effect::{Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::kind::Kind;
use super::marks::Mark;

/// Samples left out at given times. Over a long record neither spectrum nor Allan variance shows
/// it, so the law is 1: lines lose their phase, random walks take one larger step.
#[derive(Debug, Clone, PartialEq)]
pub struct Dropped(
    /// Each gap: its time in seconds since the start, counted by the samples that are left, and
    /// how many are missing.
    pub Vec<(f64, f64)>,
);

impl Distortion for Dropped {
    fn stage(&self) -> Stage {
        Stage::Reading
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        let gap = |&(time_s, samples): &(f64, f64)| Gap {
            from: (time_s * rate_hz).round() as u64,
            missing: samples as u64,
        };
        let mut gaps: Vec<Gap> = self.0.iter().map(gap).collect();
        gaps.sort_by_key(|gap| std::cmp::Reverse(gap.from));
        Box::new(Dropper { gaps, sent: 0 })
    }
}

struct Gap {
    /// Samples that are sent before it.
    from: u64,
    missing: u64,
}

struct Dropper {
    /// Those to come, the next one last.
    gaps: Vec<Gap>,
    sent: u64,
}

impl Distorter for Dropper {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        samples.retain(|_| {
            while self
                .gaps
                .pop_if(|gap| gap.from <= self.sent && gap.missing == 0)
                .is_some()
            {}
            if let Some(gap) = self.gaps.last_mut().filter(|gap| gap.from <= self.sent) {
                gap.missing -= 1;
                return false;
            }
            self.sent += 1;
            true
        });
    }
}

/// Dropped samples in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "dropped"
    }

    fn meaning(&self) -> &'static str {
        "samples are missing and nothing says so: a buffer ran over, or a ready signal was missed"
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let row = |number| {
            [
                Parameter::new(
                    "time_s",
                    Quantity::Instant,
                    "where, counted by the samples that are there",
                )
                .in_row(number),
                Parameter::new("samples", Quantity::Count, "how many are missing").in_row(number),
            ]
        };
        (1..=values.len().div_ceil(2).max(1))
            .flat_map(row)
            .collect()
    }

    fn check(&self, values: &[f64]) -> String {
        let total: f64 = values.chunks_exact(2).map(|row| row[1]).sum();
        format!(
            "compare the record's length with a clock: {total:.0} samples are missing, the first \
             at {:.3} s; look at the reader's buffers, and send sequence numbers",
            values
                .chunks_exact(2)
                .map(|row| row[0])
                .fold(f64::INFINITY, f64::min)
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let rows = values.chunks_exact(2);
        rows.map(|row| Mark::Moment(row[0])).collect()
    }

    fn part(&self, values: &[f64]) -> Part {
        let gaps = values.chunks_exact(2).map(|row| (row[0], row[1]));
        Part::Distortion(Box::new(Dropped(gaps.collect())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_out_what_it_says() {
        let dropped = Dropped(vec![(0.5, 3.0), (0.2, 2.0), (0.3, 0.0), (0.5, 1.0)]);
        let mut samples: Vec<f64> = (0..100).map(f64::from).collect();
        let seed = Seed { seed: 1, stream: 0 };
        dropped.distorter(100.0, seed).apply(&mut samples);
        let expected = (0..20).chain(22..52).chain(56..100).map(f64::from);
        assert_eq!(samples, expected.collect::<Vec<f64>>());
    }
}
