//! A sinusoid: the sixth of the seven noises that the source names.

use std::f64::consts::{PI, TAU};

use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::random::{self, Generator};
use super::{Line, Seed, Term};

/// `amplitude * cos(2 pi f_hz t + phase)`, the phase being any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoid {
    /// Frequency, hertz.
    pub f_hz: f64,
    /// Amplitude (half of peak to peak), unit of the signal.
    pub amplitude: f64,
}

impl Term for Sinusoid {
    /// Of the sampled sinusoid, `A^2 sin^4(pi f m tau0) / (m sin(pi f tau0))^2`.
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        let x = PI * self.f_hz / rate_hz;
        let chord = m as f64 * x.sin();
        if chord.abs() < f64::EPSILON {
            // A whole number of periods a sample: a constant.
            return 0.0;
        }
        self.amplitude.powi(2) * (m as f64 * x).sin().powi(4) / chord.powi(2)
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        let x = PI * self.f_hz * tau_s;
        self.amplitude.powi(2) * x.sin().powi(4) / x.powi(2)
    }

    fn spectrum(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn spectrum_ahead(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn lines(&self) -> Vec<Line> {
        vec![Line {
            f_hz: self.f_hz,
            power: 0.5 * self.amplitude.powi(2),
        }]
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        Box::new(self.oscillator(rate_hz, &mut random::random(seed)))
    }
}

impl Sinusoid {
    /// The sinusoid with a phase from `random`.
    pub(super) fn oscillator(&self, rate_hz: f64, random: &mut Pcg64) -> Oscillator {
        let turn = Uniform::new(0.0, 1.0).expect("the bounds are in order");
        Oscillator {
            amplitude: self.amplitude,
            turns_per_sample: self.f_hz / rate_hz,
            start: turn.sample(random),
            index: 0,
            value: (0.0, 0.0),
        }
    }
}

/// Periods of a sinusoid at which its Allan variance is largest: the first maximum of
/// `sin^4(pi x) / (pi x)^2`, at `tan(pi x) = 2 pi x`.
pub(super) const ALLAN_PEAK: f64 = 0.371_0;

/// Samples between two evaluations of the sine itself.
const ANCHOR: u64 = 256;

/// A pointer turned by one step a sample, and set anew from the index now and then: neither
/// rounding nor the block length shows.
pub(super) struct Oscillator {
    amplitude: f64,
    turns_per_sample: f64,
    start: f64,
    index: u64,
    value: (f64, f64),
}

impl Generator for Oscillator {
    fn add_to(&mut self, samples: &mut [f64]) {
        let (sine, cosine) = (TAU * self.turns_per_sample).sin_cos();
        for sample in samples {
            if self.index.is_multiple_of(ANCHOR) {
                let turns = self.turns_per_sample * self.index as f64;
                let (s, c) = (TAU * (turns.fract() + self.start)).sin_cos();
                self.value = (self.amplitude * c, self.amplitude * s);
            }
            let (x, y) = self.value;
            *sample += x;
            self.value = (x * cosine - y * sine, x * sine + y * cosine);
            self.index += 1;
        }
    }
}

/// The sinusoid in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

/// Place of the amplitude among the values.
pub const AMPLITUDE: usize = 1;

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "sinusoid"
    }

    fn meaning(&self) -> &'static str {
        "a line at one frequency: a rotating machine, a clock, a beat of two clocks"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("f_hz", Quantity::Hertz, "frequency"),
            Parameter::new("amplitude", Quantity::Signal, "half of peak to peak"),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "look for what turns or switches {:.6} times a second, or at a multiple of the data \
             rate from it: change the data rate by a percent, an alias moves",
            values[0]
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let f_hz = values[0];
        vec![
            Mark::Line { f_hz, multiple: 1 },
            Mark::AveragingTime(ALLAN_PEAK / f_hz),
        ]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(Sinusoid {
            f_hz: values[0],
            amplitude: values[1],
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulated_sinusoid_has_its_allan_variance() {
        // Over whole periods the sum is exact, whatever the phase.
        for (f_hz, m) in [(25.0, 1_u64), (25.0, 3), (10.0, 7), (1.0, 40)] {
            let sinusoid = Sinusoid {
                f_hz,
                amplitude: 3.0,
            };
            let rate_hz = 100.0;
            let count = 10_000;
            let mut samples = vec![0.0; count + 2 * m as usize];
            let seed = Seed { seed: 5, stream: 0 };
            sinusoid.generator(rate_hz, seed).add_to(&mut samples);
            let mean =
                |from: usize| samples[from..from + m as usize].iter().sum::<f64>() / m as f64;
            let sum: f64 = (0..count)
                .map(|k| (mean(k + m as usize) - mean(k)).powi(2))
                .sum();
            let measured = 0.5 * sum / count as f64;
            let expected = sinusoid.allan_variance(m, rate_hz);
            assert!(
                (measured - expected).abs() < 1e-9 * expected.max(1e-6),
                "{f_hz} Hz, m = {m}: {measured} for {expected}"
            );
        }
    }

    #[test]
    fn long_averages_tend_to_continuous_time() {
        let sinusoid = Sinusoid {
            f_hz: 0.013,
            amplitude: 2.0,
        };
        let (sampled, continuous) = (
            sinusoid.allan_variance(3000, 100.0),
            sinusoid.allan_asymptote(30.0),
        );
        assert!((sampled / continuous - 1.0).abs() < 1e-6);
        // 23 % above the continuous form at a quarter of the rate and m = 1.
        let quarter = Sinusoid {
            f_hz: 25.0,
            amplitude: 1.0,
        };
        let ratio = quarter.allan_variance(1, 100.0) / quarter.allan_asymptote(0.01);
        assert!((ratio - PI * PI / 8.0).abs() < 1e-12, "{ratio}");
    }
}
