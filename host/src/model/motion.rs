//! Motion: for a while something moves the sensor, which may lie otherwise afterwards.
//!
//! A hand on the block or its cable, people who walk past, a lorry outside. It has no course that a later
//! record would have again; what stays the same is how strong it was, about which frequencies, and for how long:
//! bands of noise that come up and fade between two times, which have no mean, and a level of its own meanwhile: what is turned has a
//! rate for as long as that takes, what lies on its side has gravity.

mod course;
mod envelope;
mod level;
mod stretch;
mod sums;

use std::sync::OnceLock;

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::once::Once;
use super::random::Generator;
use super::{Seed, Term};
use course::{Moved, Passing};
use sums::Sums;

pub use envelope::Envelope;
pub use level::Level;
pub use stretch::Stretch;

/// Numbers that describe one band of a stretch.
pub const ROW: usize = 8;

/// Place of the step among them.
pub const STEP: usize = 2;

/// Place of the level meanwhile among them.
pub const MEAN: usize = 6;

/// Place of how long it takes to come up among them.
pub const FADE: usize = 7;

/// Stretches at given times. As for [`Steps`](super::steps::Steps) the law says zero, as they do not come again;
/// what they add to a record that holds them is said by [`Once::in_record`].
#[derive(Debug)]
pub struct Motion {
    /// Each of them; one of several bands is there once for each, its step and its level meanwhile with one of them.
    stretches: Vec<Stretch>,
    /// What they add to a record of so many samples, so many a second, as it was first asked for.
    sums: OnceLock<((u64, f64), Vec<Sums>)>,
}

impl Motion {
    /// Of some stretches, each with as many rows as it has bands, one after another.
    pub fn new(stretches: Vec<Stretch>) -> Self {
        Self {
            stretches,
            sums: OnceLock::new(),
        }
    }

    /// What each while adds to a record.
    fn sums(&self, samples: u64, rate_hz: f64) -> Vec<Sums> {
        let whiles = self.stretches.chunk_by(Stretch::is_beside);
        let sums = |all: &[Stretch]| {
            let bands: Vec<_> = all.iter().map(|one| one.band).collect();
            let (_, envelope) = all[0].samples(rate_hz);
            Sums::new(&bands, &envelope.within(samples), rate_hz)
        };
        whiles.map(sums).collect()
    }
}

impl Once for Motion {
    fn in_record(&self, m: u64, samples: u64, rate_hz: f64) -> f64 {
        let of = |all: &[Sums]| all.iter().map(|one| one.allan_variance(m, samples)).sum();
        let record = (samples, rate_hz);
        let (first, known) = self
            .sums
            .get_or_init(|| (record, self.sums(samples, rate_hz)));
        if *first == record {
            of(known)
        } else {
            of(&self.sums(samples, rate_hz))
        }
    }

    fn density_in_record(&self, f_hz: f64, record_s: f64, rate_hz: f64) -> f64 {
        let own = |one: &Stretch| one.duration_s / record_s * one.density(f_hz, rate_hz);
        self.stretches.iter().map(own).sum()
    }

    fn course(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let stretch = |(stream, one): (u64, &Stretch)| {
            let drawn = |draw: u64| {
                let own = stream.rotate_left(32) ^ draw.rotate_left(16);
                let own = Seed {
                    seed: seed.seed,
                    stream: seed.stream ^ own,
                };
                one.band.generator(rate_hz, own)
            };
            Passing::new(one.level(rate_hz), &one.band, drawn)
        };
        Box::new(Moved {
            stretches: (1..).zip(&self.stretches).map(stretch).collect(),
            index: 0,
        })
    }
}

/// Motion in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "motion"
    }

    fn meaning(&self) -> &'static str {
        "for a while something moves the sensor: a hand on the block or its cable, people who walk past, a lorry \
         outside; it may lie otherwise afterwards"
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let row = |number| {
            [
                Parameter::new("time_s", Quantity::Instant, "when it begins"),
                Parameter::new("duration_s", Quantity::Second, "how long it lasts"),
                Parameter::new(
                    "step",
                    Quantity::Signal,
                    "the level afterwards less that before; once where a stretch has several bands",
                ),
                Parameter::new(
                    "f_hz",
                    Quantity::Centre,
                    "middle of the band that moves",
                ),
                Parameter::new(
                    "width_hz",
                    Quantity::Hertz,
                    "its width at half the power",
                ),
                Parameter::new(
                    "amplitude",
                    Quantity::Signal,
                    "its root mean square while it lasts",
                ),
                Parameter::new(
                    "mean",
                    Quantity::Signal,
                    "the level meanwhile less the middle of those before and afterwards; once where a stretch has several bands",
                )
                .or_zero(),
                Parameter::new(
                    "fade_s",
                    Quantity::SecondOrNone,
                    "how long it takes to come up, and as long to fade",
                )
                .or_zero(),
            ]
            .map(|one| one.in_row(number))
        };
        (1..=values.len().div_ceil(ROW).max(1))
            .flat_map(row)
            .collect()
    }

    fn check(&self, values: &[f64]) -> String {
        let all = || values.chunks_exact(ROW).map(Stretch::of);
        let strongest = all()
            .max_by(|a, b| a.band.amplitude.total_cmp(&b.band.amplitude))
            .expect("at least one stretch");
        let (f_hz, width_hz) = (strongest.band.f_hz, strongest.band.width_hz);
        let place = if f_hz < 0.5 * width_hz {
            format!("below {:.3}", f_hz + 0.5 * width_hz)
        } else {
            format!("about {f_hz:.3}")
        };
        format!(
            "recall what went on from {:.2} s to {:.2} s, where it is strongest, {place} Hz; look at the other \
             axes and at whether the levels came back: what was touched lies otherwise, what was driven by does not",
            strongest.time_s,
            strongest.time_s + strongest.duration_s,
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let rows = values.chunks_exact(ROW).map(Stretch::of);
        let mut marks: Vec<Mark> = rows
            .map(|one| Mark::Stretch(one.time_s, one.time_s + one.duration_s))
            .collect();
        // The bands of a stretch lie side by side.
        marks.dedup();
        marks
    }

    fn part(&self, values: &[f64]) -> Part {
        let rows = values.chunks_exact(ROW).map(Stretch::of);
        Part::Term(Box::new(Motion::new(rows.collect())))
    }
}

#[cfg(test)]
mod tests;
