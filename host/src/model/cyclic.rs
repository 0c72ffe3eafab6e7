//! Cyclic: the noise grows and shrinks at a period.

use std::f64::consts::TAU;

use super::Seed;
use super::effect::{Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::kind::Kind;

/// What varies is multiplied by `(1 + depth cos(2 pi t / period_s + phase_rad)) / sqrt(1 + depth^2 / 2)`, the level
/// is not.
///
/// The level is the running mean over a period: what is slower than that stays as it is. The root
/// makes the mean square of the factor one, so that the five terms are those of the record's mean
/// spectrum, and the law leaves it at 1: exact for white noise. Of coloured noise a part
/// `depth^2 / (2 + depth^2)` is moved by one over the period to either side, which changes the density only
/// where it bends within that. Averages over much less or more than a period have the Allan variance
/// of steady noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cyclic {
    /// How far the standard deviation swings about its mean, over that mean; 0 to 1.
    pub depth: f64,
    /// Period, seconds.
    pub period_s: f64,
    /// Phase of the cosine at the start of the record, radians.
    pub phase_rad: f64,
}

impl Cyclic {
    /// With these parameters, in the catalogue's order.
    pub fn of(values: &[f64]) -> Self {
        Self {
            depth: values[0],
            period_s: values[1],
            phase_rad: values[2],
        }
    }

    /// Factor on the standard deviation of the noise at a time since the start of the record.
    pub fn factor(&self, time_s: f64) -> f64 {
        // Whole periods are taken off first, or the cosine of a large angle would be rounded.
        let cycles = (time_s / self.period_s).fract();
        let swing = self.depth * (TAU * cycles + self.phase_rad).cos();
        (1.0 + swing) / (1.0 + 0.5 * self.depth * self.depth).sqrt()
    }
}

impl Distortion for Cyclic {
    fn stage(&self) -> Stage {
        Stage::Noise
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        Box::new(Breathing {
            law: *self,
            rate_hz,
            memory: (self.period_s * rate_hz).max(1.0),
            index: 0,
            level: 0.0,
        })
    }
}

struct Breathing {
    law: Cyclic,
    rate_hz: f64,
    /// Samples over which the level is averaged.
    memory: f64,
    index: u64,
    level: f64,
}

impl Distorter for Breathing {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        for sample in samples {
            // The plain mean of what there is, until that is long enough.
            let known = (self.index as f64 + 1.0).min(self.memory);
            self.level += (*sample - self.level) / known;
            let factor = self.law.factor(self.index as f64 / self.rate_hz);
            *sample = self.level + factor * (*sample - self.level);
            self.index += 1;
        }
    }
}

/// Cyclic noise in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "cyclic"
    }

    fn meaning(&self) -> &'static str {
        "the noise grows and shrinks at a period: a machine that turns slowly, air conditioning, \
         heating or a fan that is regulated, a supply whose ripple beats"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new(
                "depth",
                Quantity::Share,
                "swing of the standard deviation about its mean",
            ),
            Parameter::new("period_s", Quantity::Second, "period"),
            Parameter::new(
                "phase_rad",
                Quantity::Ratio,
                "phase of the cosine at the start, radians",
            ),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "look for what has a period of {:.3} s, such as heating, a fan or a pump, and switch it \
             off: if it is the cause, the noise no longer swings by {:.0} %",
            values[1],
            100.0 * values[0]
        )
    }

    fn size(&self) -> Option<usize> {
        None
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Cyclic::of(values)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::{Gaussian, Generator};

    const LAW: Cyclic = Cyclic {
        depth: 0.6,
        period_s: 2.5,
        phase_rad: 1.1,
    };
    const RATE_HZ: f64 = 1000.0;

    /// White noise of deviation 1 about a level, made cyclic.
    fn record(seed: Seed, count: usize) -> Vec<f64> {
        let mut samples = vec![9.8; count];
        Gaussian::new(seed, 1.0).add_to(&mut samples);
        LAW.distorter(RATE_HZ, seed).apply(&mut samples);
        samples
    }

    #[test]
    fn the_variance_follows_the_square_of_the_factor() {
        const COUNT: usize = 123_456;
        let seed = Seed {
            seed: 11,
            stream: 0,
        };
        let samples = record(seed, COUNT);
        // Squares in twelve parts of a cycle, from the second on, when there is a level.
        let (mut squares, mut laws, mut counts) = ([0.0_f64; 12], [0.0_f64; 12], [0.0_f64; 12]);
        for (index, sample) in samples.iter().enumerate().skip(2500) {
            let time_s = index as f64 / RATE_HZ;
            let part = (12.0 * (time_s / LAW.period_s).fract()) as usize;
            squares[part] += (sample - 9.8).powi(2);
            laws[part] += LAW.factor(time_s).powi(2);
            counts[part] += 1.0;
        }
        for part in 0..12 {
            // The level is a mean of 2500, known to 1/2500 of the variance of one; five sigma.
            let z = (squares[part] / laws[part] - 1.0) / (2.0 / counts[part]).sqrt();
            assert!(z.abs() < 5.0, "{seed:?}, part {part}: {z} sigma");
        }
    }

    #[test]
    fn mean_power_and_level_stay() {
        const COUNT: usize = 250_000;
        let seed = Seed {
            seed: 12,
            stream: 0,
        };
        let samples = record(seed, COUNT);
        let count = COUNT as f64;
        let mean = samples.iter().sum::<f64>() / count;
        // By the scatter of independent samples of mean square one.
        let z = (mean - 9.8) * count.sqrt();
        assert!(z.abs() < 5.0, "{seed:?}: mean {mean}, {z} sigma");
        let square = samples.iter().map(|x| (x - 9.8).powi(2)).sum::<f64>() / count;
        // Two times the mean fourth power of the factor over its mean square's square.
        let [second, fourth] = [2, 4].map(|power| {
            let powers = (0..2500).map(|n| LAW.factor(f64::from(n) / RATE_HZ).powi(power));
            powers.sum::<f64>() / 2500.0
        });
        assert!((second - 1.0).abs() < 1e-12, "{second}");
        let z = (square - 1.0) / (2.0 * fourth / count).sqrt();
        assert!(z.abs() < 5.0, "{seed:?}: mean square {square}, {z} sigma");
    }

    #[test]
    fn a_level_that_moves_slowly_stays() {
        // A ramp of one over the whole of a hundred periods, without noise.
        const COUNT: usize = 250_000;
        let mut samples: Vec<f64> = (0..COUNT).map(|n| n as f64 / COUNT as f64).collect();
        let plain = samples.clone();
        let seed = Seed { seed: 1, stream: 0 };
        LAW.distorter(RATE_HZ, seed).apply(&mut samples);
        for (index, (sample, plain)) in samples.iter().zip(&plain).enumerate() {
            // The running mean lags by a period, a hundredth of the ramp; the factor is within 0.6 of one.
            assert!((sample - plain).abs() < 0.01, "{index}: {sample}, {plain}");
        }
    }
}
