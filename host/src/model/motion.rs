//! Motion: for a while something moves the sensor, which may lie otherwise afterwards.
//!
//! A hand on the block or its cable, people who walk past, a lorry outside. It has no course that a later
//! record would have again; what stays the same is how strong it was, about which frequencies, and for how long:
//! bands of noise that are let in between two times. What is at rest before and after comes back on the whole: the noise of
//! a stretch has no mean.

use std::f64::consts::PI;

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::once::Once;
use super::random::Generator;
use super::unnamed::Band;
use super::{Seed, Term};

/// Numbers that describe one band of a stretch.
pub const ROW: usize = 6;

/// Place of the step among them.
pub const STEP: usize = 2;

/// A band of noise that is let in for a while, and a change of the level meanwhile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// When it begins, seconds since the start of the record.
    pub time_s: f64,
    /// How long it lasts, seconds.
    pub duration_s: f64,
    /// The level afterwards less that before, in the unit of the signal.
    pub step: f64,
    /// What it adds to the noise.
    pub band: Band,
}

impl Stretch {
    /// With these parameters, in the catalogue's order.
    pub fn of(row: &[f64]) -> Self {
        Self {
            time_s: row[0],
            duration_s: row[1],
            step: row[STEP],
            band: Band::of(&row[3..ROW]),
        }
    }

    /// The first of its samples, and the first after it.
    fn samples(&self, rate_hz: f64) -> (u64, u64) {
        /// No record has a sample of this number, and there is room for more behind it.
        const LATEST: f64 = (1_u64 << 62) as f64;
        let number = |time_s: f64| (time_s * rate_hz).round().clamp(0.0, LATEST) as u64;
        let (from, to) = (number(self.time_s), number(self.time_s + self.duration_s));
        (from, to.max(from + 1))
    }

    /// Two-sided density at `f_hz` while it lasts: that of the band, which a stretch of `T` seconds widens by `1/T`, less
    /// that of its mean.
    pub fn density(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let width_hz = self.band.width_hz.hypot(self.duration_s.recip());
        let band = Band {
            width_hz,
            ..self.band
        };
        let half_turn = PI * f_hz * self.duration_s;
        let of_mean = if half_turn == 0.0 {
            1.0
        } else {
            half_turn.sin() / half_turn
        };
        band.spectrum(f_hz, rate_hz) * (1.0 - of_mean * of_mean)
    }

    /// What its noise adds to the Allan variance over `m` samples of a record of `samples`, in the mean, where it is
    /// further from both ends than that.
    ///
    /// Averaged over all places in the record, `(4 S(m) - S(2 m)) / (2 m^2)` of the squares `S(k)` of sums over `k`
    /// samples, over the number of places.
    fn allan_variance(&self, m: u64, samples: u64, rate_hz: f64) -> f64 {
        let (from, to) = self.samples(rate_hz);
        let sums = Sums::new(&self.band, (to - from).min(samples) as usize, rate_hz);
        let places = samples.saturating_sub(2 * m) + 1;
        let m = m as usize;
        let square = (4.0 * sums.over(m) - sums.over(2 * m)) / places as f64;
        (square / (2.0 * (m as f64).powi(2))).max(0.0)
    }
}

/// Sums of the noise of a stretch, whose mean is none.
struct Sums {
    /// Mean square of a sum over as many samples of noise that always was there.
    squares: Vec<f64>,
}

impl Sums {
    fn new(band: &Band, length: usize, rate_hz: f64) -> Self {
        /// Of a covariance that is a part of the first one this small, nothing is left to add: a choice.
        const NOTHING: f64 = 1e-12;
        let first = band.covariance(0.0);
        let (mut squares, mut square, mut growth) = (vec![0.0], 0.0, first);
        let mut is_over = false;
        for lag in 1..=length {
            square += growth;
            squares.push(square);
            let lag_s = lag as f64 / rate_hz;
            is_over |= band.bound(lag_s) < NOTHING * first;
            if !is_over {
                growth += 2.0 * band.covariance(lag_s);
            }
        }
        Self { squares }
    }

    /// Mean square of the sum over `count` samples from `first` on, less their share of the sum over all.
    fn square(&self, first: usize, count: usize) -> f64 {
        let v = &self.squares;
        let length = v.len() - 1;
        let share = count as f64 / length as f64;
        let last = first + count;
        let with_all = v[last] - v[first] + v[length - first] - v[length - last];
        (v[count] + share * share * v[length] - share * with_all).max(0.0)
    }

    /// Sum of the squares of the sums over `k` samples at all places.
    fn over(&self, k: usize) -> f64 {
        let length = self.squares.len() - 1;
        // On both ends only a part of the samples is of the stretch.
        let ends = (1..k.min(length)).map(|count| self.square(0, count));
        let within = (0..(length + 1).saturating_sub(k)).map(|first| self.square(first, k));
        2.0 * ends.sum::<f64>() + within.sum::<f64>()
    }
}

/// Stretches at given times. As for [`Steps`](super::steps::Steps) the law says zero, as they do not come again;
/// what they add to a record that holds them is said by [`Once::in_record`].
#[derive(Debug, Clone, PartialEq)]
pub struct Motion(
    /// Each of them; one of several bands is there once for each, its step with one of them.
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

struct Passing {
    from: u64,
    to: u64,
    step: f64,
    mean: f64,
    noise: Box<dyn Generator>,
}

/// Mean of the first `count` samples of some noise.
fn mean(mut noise: Box<dyn Generator>, count: u64) -> f64 {
    /// Samples that are made at once: a choice.
    const BLOCK: u64 = 4096;
    let blocks = (0..count).step_by(BLOCK as usize).map(|from| {
        let mut block = vec![0.0; (count - from).min(BLOCK) as usize];
        noise.add_to(&mut block);
        block.iter().sum::<f64>()
    });
    blocks.sum::<f64>() / count as f64
}

struct Moved {
    stretches: Vec<Passing>,
    index: u64,
}

impl Generator for Moved {
    fn add_to(&mut self, samples: &mut [f64]) {
        let first = self.index;
        let end = first + samples.len() as u64;
        for one in &mut self.stretches {
            let (from, to) = (one.from.max(first), one.to.min(end));
            if from < to {
                let part = &mut samples[(from - first) as usize..(to - first) as usize];
                one.noise.add_to(part);
                part.iter_mut().for_each(|sample| *sample -= one.mean);
            }
            // The level goes over in the middle of it.
            let middle = one.from.midpoint(one.to).clamp(first, end);
            let after = &mut samples[(middle - first) as usize..];
            after.iter_mut().for_each(|sample| *sample += one.step);
        }
        self.index = end;
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
            let name = |of: &str| format!("{of}_{number}");
            [
                Parameter::new(name("time_s"), Quantity::Instant, "when it begins"),
                Parameter::new(name("duration_s"), Quantity::Second, "how long it lasts"),
                Parameter::new(
                    name("step"),
                    Quantity::Signal,
                    "the level afterwards less that before; once where a stretch has several bands",
                ),
                Parameter::new(
                    name("f_hz"),
                    Quantity::Centre,
                    "middle of the band that moves",
                ),
                Parameter::new(
                    name("width_hz"),
                    Quantity::Hertz,
                    "its width at half the power",
                ),
                Parameter::new(
                    name("amplitude"),
                    Quantity::Signal,
                    "its root mean square while it lasts",
                ),
            ]
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
        format!(
            "recall what went on from {:.2} s to {:.2} s, where it is strongest, about {:.3} Hz; look at the other \
             axes and at whether the levels came back: what was touched lies otherwise, what was driven by does not",
            strongest.time_s,
            strongest.time_s + strongest.duration_s,
            strongest.band.f_hz,
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

    const RATE_HZ: f64 = 100.0;

    fn stretch(f_hz: f64, width_hz: f64) -> Stretch {
        Stretch {
            time_s: 50.0,
            duration_s: 13.0,
            step: 0.0,
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

    /// The mean over records comes to what is expected, from the shortest averages to those longer than the stretch.
    #[test]
    fn a_motion_beyond_the_end_of_time_adds_nothing() {
        let motion = Motion(vec![Stretch::of(&[5e107, 0.5, -0.02, 3.0, 1.0, 0.05])]);
        let mut samples = vec![0.0; 1000];
        let seed = Seed { seed: 1, stream: 0 };
        motion.course(RATE_HZ, seed).add_to(&mut samples);
        assert!(samples.iter().all(|sample| *sample == 0.0));
    }

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
