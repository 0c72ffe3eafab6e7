//! Shock: short transients, such as a knock, a door that slams, a footstep or a hand on the block.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use super::Seed;
use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::once::Once;
use super::random::Generator;
use crate::numeric::turning::turning;

/// Numbers that describe one shock.
const ROW: usize = 5;

/// One transient: `e^(-t/decay) sin(2 pi f t)`, what a resonator answers to a blow, over the time that it
/// lasts; where it does not ring, half a period of a sine, the pulse of a shock test (IEC 60068-2-27).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shock {
    /// When it begins, seconds since the start of the record.
    pub time_s: f64,
    /// Its largest deflection, in the unit of the signal; the first half period has its sign.
    pub peak: f64,
    /// How long it lasts, seconds; nothing is left of it after that.
    pub duration_s: f64,
    /// Frequency of its ringing, hertz; zero where it does not ring.
    pub f_hz: f64,
    /// Time in which the ringing falls to 1/e, seconds; zero where it does not fall.
    pub decay_s: f64,
}

impl Shock {
    /// With these parameters, in the catalogue's order.
    pub fn of(row: &[f64]) -> Self {
        Self {
            time_s: row[0],
            peak: row[1],
            duration_s: row[2],
            f_hz: row[3],
            decay_s: row[4],
        }
    }

    /// Deflection `t_s` after its beginning.
    pub fn at(&self, t_s: f64) -> f64 {
        if self.outside(t_s) {
            return 0.0;
        }
        self.peak * self.shape(t_s) / self.highest()
    }

    fn outside(&self, t_s: f64) -> bool {
        !(0.0..self.duration_s).contains(&t_s)
    }

    fn shape(&self, t_s: f64) -> f64 {
        if self.f_hz == 0.0 {
            return (PI * t_s / self.duration_s).sin();
        }
        (-self.fall_per_s() * t_s).exp() * (TAU * self.f_hz * t_s).sin()
    }

    /// What its logarithm falls by in a second.
    fn fall_per_s(&self) -> f64 {
        if self.decay_s > 0.0 {
            self.decay_s.recip()
        } else {
            0.0
        }
    }

    /// The largest value of its shape, which it reaches within the first quarter of a period.
    fn highest(&self) -> f64 {
        if self.f_hz == 0.0 {
            return 1.0;
        }
        let turn = TAU * self.f_hz;
        let quarter_s = 0.25 / self.f_hz;
        let top_s = if self.decay_s > 0.0 {
            (turn * self.decay_s).atan() / turn
        } else {
            quarter_s
        };
        // One that ends before is highest at its end.
        self.shape(top_s.min(self.duration_s))
    }

    /// Adds it to samples, of which the first has the number `first`, at a data rate.
    pub fn add_to(&self, first: u64, samples: &mut [f64], rate_hz: f64) {
        let number = |t_s: f64| (t_s * rate_hz).ceil().max(0.0) as u64;
        let from = number(self.time_s).max(first);
        let to = number(self.time_s + self.duration_s).saturating_add(1);
        let end = first + samples.len() as u64;
        if from >= end || to <= first {
            return;
        }
        let size = self.peak / self.highest();
        let begins = number(self.time_s);
        let rate_per_s = match self.f_hz {
            0.0 => Complex64::new(0.0, PI / self.duration_s),
            f_hz => Complex64::new(-self.fall_per_s(), TAU * f_hz),
        };
        let t_s = |index: u64| index as f64 / rate_hz - self.time_s;
        let course = turning(from - begins, (rate_per_s / rate_hz).exp(), |passed| {
            (rate_per_s * t_s(begins + passed)).exp()
        });
        for (index, course) in (from..to.min(end)).zip(course) {
            if !self.outside(t_s(index)) {
                samples[(index - first) as usize] += size * course.im;
            }
        }
    }
}

/// Transients at given times. Not random, and no two records have them alike: as for
/// [`Steps`](super::steps::Steps) the law says zero, and whoever knows the record knows the course.
#[derive(Debug, Clone, PartialEq)]
pub struct Shocks(
    /// Each of them.
    pub Vec<Shock>,
);

impl Once for Shocks {
    fn course(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Generator> {
        Box::new(Transients {
            shocks: self.0.clone(),
            rate_hz,
            index: 0,
        })
    }
}

struct Transients {
    shocks: Vec<Shock>,
    rate_hz: f64,
    index: u64,
}

impl Generator for Transients {
    fn add_to(&mut self, samples: &mut [f64]) {
        for shock in &self.shocks {
            shock.add_to(self.index, samples, self.rate_hz);
        }
        self.index += samples.len() as u64;
    }
}

/// Shocks in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "shock"
    }

    fn meaning(&self) -> &'static str {
        "short transients: a knock, a door that slammed, a footstep, a hand on the block or its cable"
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let row = |number| {
            [
                Parameter::new("time_s", Quantity::Instant, "when it begins"),
                Parameter::new("peak", Quantity::Signal, "its largest deflection"),
                Parameter::new("duration_s", Quantity::Second, "how long it lasts"),
                Parameter::new(
                    "f_hz",
                    Quantity::HertzOrNone,
                    "frequency of its ringing, 0 where it does not ring",
                ),
                Parameter::new(
                    "decay_s",
                    Quantity::SecondOrNone,
                    "time in which the ringing falls to 1/e, 0 where it does not fall",
                ),
            ]
            .map(|one| one.in_row(number))
        };
        (1..=values.len().div_ceil(ROW).max(1))
            .flat_map(row)
            .collect()
    }

    fn check(&self, values: &[f64]) -> String {
        let all = || values.chunks_exact(ROW).map(Shock::of);
        let largest = all()
            .max_by(|a, b| a.peak.abs().total_cmp(&b.peak.abs()))
            .expect("at least one shock");
        let rings = if largest.f_hz > 0.0 {
            format!(", which rings at {:.4} Hz", largest.f_hz)
        } else {
            String::new()
        };
        format!(
            "recall what happened from {:.2} s to {:.2} s, at the largest of {}{rings}; one in all axes at once \
             came through the block, and its ringing is that of the block on its feet: tap it and compare",
            largest.time_s,
            largest.time_s + largest.duration_s,
            all().count(),
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let rows = values.chunks_exact(ROW).map(Shock::of);
        rows.map(|one| Mark::Stretch(one.time_s, one.time_s + one.duration_s))
            .collect()
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(Shocks(
            values.chunks_exact(ROW).map(Shock::of).collect(),
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(shock: Shock, rate_hz: f64, count: usize) -> Vec<f64> {
        let mut samples = vec![0.0; count];
        let seed = Seed { seed: 1, stream: 0 };
        let mut generator = Shocks(vec![shock]).course(rate_hz, seed);
        for block in samples.chunks_mut(97) {
            generator.add_to(block);
        }
        samples
    }

    #[test]
    fn rings_at_its_frequency_and_falls_by_e_in_its_decay() {
        let shock = Shock {
            time_s: 0.3,
            peak: -2.0,
            duration_s: 0.5,
            f_hz: 50.0,
            decay_s: 0.1,
        };
        let samples = made(shock, 100_000.0, 100_000);
        let highest = samples
            .iter()
            .copied()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        // The samples lie 0.03 rad apart: next to the top 5e-4 are lost at most.
        assert!((highest - 2.0).abs() < 1e-3, "{highest}");
        assert!(samples[30_001] < 0.0, "begins to the side of its peak");
        assert!(samples[..30_000].iter().all(|one| *one == 0.0));
        assert!(samples[80_001..].iter().all(|one| *one == 0.0));
        // Five periods are one decay.
        let (now, later) = (samples[30_500 - 77], samples[40_500 - 77]);
        assert!(
            (later / now - (-1.0_f64).exp()).abs() < 1e-9,
            "{now} {later}"
        );
    }

    #[test]
    fn what_does_not_ring_is_half_a_sine() {
        let shock = Shock {
            time_s: 0.1,
            peak: 3.0,
            duration_s: 0.2,
            f_hz: 0.0,
            decay_s: 0.0,
        };
        let samples = made(shock, 1000.0, 1000);
        let sum: f64 = samples.iter().sum();
        // The mean of half a sine is 2 / pi of its height.
        let expected = 3.0 * 200.0 * 2.0 / PI;
        assert!((sum / expected - 1.0).abs() < 1e-4, "{sum} for {expected}");
        assert!((samples[200] - 3.0).abs() < 1e-9, "{}", samples[200]);
    }
}
