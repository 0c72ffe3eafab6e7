//! Motion: for a while something moves the sensor, which may lie otherwise afterwards.
//!
//! A hand on the block or its cable, people who walk past, a lorry outside. It has no course that a later
//! record would have again; what stays the same is how strong it was, about which frequencies, and for how long:
//! bands of noise that are let in between two times, which have no mean, and a level of its own meanwhile: what is turned has a
//! rate for as long as that takes, what lies on its side has gravity.

mod course;
mod stretch;

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::once::Once;
use super::random::Generator;
use super::{Seed, Term};
use course::{Moved, Passing, mean};

pub use stretch::Stretch;

/// Numbers that describe one band of a stretch.
pub const ROW: usize = 7;

/// Place of the step among them.
pub const STEP: usize = 2;

/// Place of the level meanwhile among them.
pub const MEAN: usize = 6;

/// Stretches at given times. As for [`Steps`](super::steps::Steps) the law says zero, as they do not come again;
/// what they add to a record that holds them is said by [`Once::in_record`].
#[derive(Debug, Clone, PartialEq)]
pub struct Motion(
    /// Each of them; one of several bands is there once for each, its step and its level meanwhile with one of them.
    pub Vec<Stretch>,
);

impl Once for Motion {
    fn in_record(&self, m: u64, samples: u64, rate_hz: f64) -> f64 {
        let all = self.0.iter();
        all.map(|one| one.allan_variance(m, samples, rate_hz)).sum()
    }

    fn density_in_record(&self, f_hz: f64, record_s: f64, rate_hz: f64) -> f64 {
        let own = |one: &Stretch| one.duration_s / record_s * one.density(f_hz, rate_hz);
        self.0.iter().map(own).sum()
    }

    fn course(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let stretch = |(stream, one): (u64, &Stretch)| {
            let (from, to) = one.samples(rate_hz);
            let own = Seed {
                seed: seed.seed,
                stream: seed.stream ^ stream.rotate_left(32),
            };
            Passing {
                from,
                to,
                step: one.step,
                level: one.mean,
                mean: mean(one.band.generator(rate_hz, own), to - from),
                noise: one.band.generator(rate_hz, own),
            }
        };
        Box::new(Moved {
            stretches: (1..).zip(&self.0).map(stretch).collect(),
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
        Part::Term(Box::new(Motion(rows.collect())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::statistic::allan_curve;
    use crate::model::unnamed::Band;

    const RATE_HZ: f64 = 100.0;

    fn stretch(f_hz: f64, width_hz: f64) -> Stretch {
        Stretch {
            time_s: 50.0,
            duration_s: 13.0,
            step: 0.0,
            mean: 0.0,
            band: Band {
                f_hz,
                width_hz,
                amplitude: 2.0,
            },
        }
    }

    fn made(stretches: Vec<Stretch>, seed: u64, count: usize) -> Vec<f64> {
        let mut samples = vec![0.0; count];
        let seed = Seed { seed, stream: 3 };
        let mut generator = Motion(stretches).course(RATE_HZ, seed);
        for block in samples.chunks_mut(97) {
            generator.add_to(block);
        }
        samples
    }

    #[test]
    fn nothing_is_outside_of_a_stretch_but_its_step() {
        let moved = Stretch {
            step: -3.0,
            ..stretch(2.0, 0.5)
        };
        let samples = made(vec![moved], 1, 20_000);
        assert!(samples[..5000].iter().all(|one| *one == 0.0));
        assert!(samples[6300..].iter().all(|one| *one == -3.0));
        let inside = &samples[5000..5650];
        let square = inside.iter().map(|one| one * one).sum::<f64>() / inside.len() as f64;
        // Ten correlation times: known to half of it.
        assert!((1.0..9.0).contains(&square), "{square}");
    }

    #[test]
    fn a_turn_has_its_rate_while_it_lasts_and_leaves_a_step() {
        let turned = Stretch {
            step: -3.0,
            mean: 5.0,
            ..stretch(2.0, 0.5)
        };
        let samples = made(vec![turned], 2, 20_000);
        assert!(samples[..5000].iter().all(|one| *one == 0.0));
        assert!(samples[6300..].iter().all(|one| *one == -3.0));
        let mean = samples[5000..6300].iter().sum::<f64>() / 1300.0;
        // The noise of the stretch has none, and the step is there for half of it.
        assert!((mean - (5.0 - 1.5)).abs() < 1e-9, "{mean}");
    }

    /// Files from before rows had a level of their own, however many rows they have.
    #[test]
    fn rows_without_a_level_are_read() {
        use crate::model::effect::in_order;
        for rows in [1, 6, 7, 50, 301] {
            let all = KIND.parameters(&vec![0.0; rows * ROW]);
            let named = all.iter().filter(|one| !one.optional);
            let named = named.map(|one| (one.name.to_string(), 1.0)).collect();
            let values = in_order(&Entry, &named).expect("a motion");
            assert_eq!(values.len(), rows * ROW, "{rows} rows");
            let levels = values.chunks(ROW).map(|row| row[MEAN]);
            assert_eq!(levels.sum::<f64>(), 0.0, "{rows} rows");
        }
    }

    #[test]
    fn a_motion_beyond_the_end_of_time_adds_nothing() {
        let motion = Motion(vec![Stretch::of(&[5e107, 0.5, -0.02, 3.0, 1.0, 0.05, 0.1])]);
        let mut samples = vec![0.0; 1000];
        let seed = Seed { seed: 1, stream: 0 };
        motion.course(RATE_HZ, seed).add_to(&mut samples);
        assert!(samples.iter().all(|sample| *sample == 0.0));
    }

    /// The mean over records comes to what is expected, from the shortest averages to those longer than the stretch.
    #[test]
    fn records_have_the_allan_variance_that_is_expected() {
        const RECORDS: u64 = 400;
        const LENGTH: usize = 16_384;
        for one in [stretch(0.0, 0.3), stretch(1.5, 0.4), stretch(20.0, 12.0)] {
            let mut sums: std::collections::BTreeMap<u64, [f64; 2]> = Default::default();
            for seed in 0..RECORDS {
                for point in allan_curve::allan(&made(vec![one], seed, LENGTH), RATE_HZ) {
                    let sum = sums.entry(point.m).or_default();
                    sum[0] += point.variance;
                    sum[1] += point.variance.powi(2);
                }
            }
            let count = RECORDS as f64;
            // Those that fit in 20 times: longer ones see the ends of the record.
            for (m, [sum, squares]) in sums.into_iter().filter(|(m, _)| *m <= LENGTH as u64 / 20) {
                let mean = sum / count;
                let sd = ((squares / count - mean * mean) / count).sqrt();
                let expected = Motion(vec![one]).in_record(m, LENGTH as u64, RATE_HZ);
                // Five standard errors of the mean, of some hundred comparisons.
                assert!(
                    (mean - expected).abs() < 5.0 * sd + 1e-9 * expected,
                    "{one:?} {m}: {mean} for {expected}, {sd}"
                );
            }
        }
    }
}
